/// \file
/// Contact of the lips with each other, without friction. Their tone closes them.
///
/// Both nodes of each pair touch the surface of the other lip: node to surface in two half passes
/// (face_lips.h; pairs of nodes: \cite francavilla1975). For a node x_0 of area A, and the point
/// sum_i N_i x_i of the other lip that it faces, with normal n:
///
///   e = n . (x_0 - sum_i N_i x_i) - e_r       opening; e_r: where the lips touch
///   W = A/2 k_c e^2          e < e_0          pressure k_c |e|; on bone it is 2 k_c d
///   W = A t (e - e_0 / 2)    e >= e_0         traction t, the resting tone; e_0 = t / k_c
///
/// At rest the tone presses the lips on each other, so that it has no effect until they open.
/// Points and normals are found at the last equilibrium and stay fixed within a load increment: an
/// increment of slip s on a surface of curvature kappa changes e by about kappa s^2 / 2. Lips that
/// slide on each other, with face-to-face contact: \cite kim2021.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/predict/face_lips.h>
#include <lefort/predict/separate_lips.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::predict {

/// An item is a node of a lip and the triangle of the other lip that it faces.
class LipContact final : public fem::ForceTerm {
 public:
  /// \param points                of the lips.
  /// \param stiffness_mpa_per_mm  k_c > 0.
  /// \param tone_mpa              t >= 0.
  LipContact(std::vector<FacingPoint> points, double stiffness_mpa_per_mm, double tone_mpa);

  /// Replaces the points if they couple the same nodes.
  /// \returns false if they do not; then nothing changes.
  [[nodiscard]] bool replace(const std::vector<FacingPoint>& points);

  [[nodiscard]] Index item_count() const override { return Index(points_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return points_[std::size_t(item)].nodes;
  }
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override;

 private:
  std::vector<FacingPoint> points_;
  double stiffness_mpa_per_mm_;
  double tone_mpa_;
};

/// Position of the lips relative to each other.
struct LipStatistics {
  double max_overlap_mm = 0.0;  ///< Of -e; 0 if there is none.
  double max_opening_mm = 0.0;  ///< Of e; 0 if there is none.
  double max_slip_mm = 0.0;     ///< Of the nodes of a pair, perpendicular to their normal at rest.
  /// Of the area: e <= kLipsClosed_mm. Nodes that face nothing are open.
  double closed_fraction = 1.0;
};
inline constexpr double kLipsClosed_mm = 0.1;

/// \param tissue           with the sets of the lips.
/// \param lips             separated.
/// \param displacement_mm  one per node of the tissue.
[[nodiscard]] LipStatistics lip_statistics(const mesh::VolumeMesh& tissue, const LipSlit& lips,
                                           std::span<const Vec3> displacement_mm);

}  // namespace lefort::predict
