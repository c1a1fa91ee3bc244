/// \file
/// Contact of the lips with each other, without friction: node to node. Their tone closes them.
///
/// For a pair of nodes at the same position at rest, with area A and normal n from the lower lip to
/// the upper one (\cite francavilla1975):
///
///   e = n . (x_upper - x_lower)               opening
///   W = A/2 k_c e^2          e < e_0          pressure k_c |e|; on bone it is 2 k_c d
///   W = A t (e - e_0 / 2)    e >= e_0         traction t, the resting tone; e_0 = t / k_c
///
/// At rest the tone presses the lips on each other, so that it has no effect until they open.
/// n is that at rest: motion perpendicular to n meets no resistance. After a slip s on a surface of
/// curvature kappa the opening is in error by about kappa s^2 / 2 (docs/theory/interface.md).
/// Lips that slide on each other, with face-to-face contact: \cite kim2021.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/predict/separate_lips.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::predict {

/// An item is a pair of nodes.
class LipContact final : public fem::ForceTerm {
 public:
  /// \param pairs                 of the lips.
  /// \param stiffness_mpa_per_mm  k_c > 0.
  /// \param tone_mpa              t >= 0.
  LipContact(std::vector<LipPair> pairs, double stiffness_mpa_per_mm, double tone_mpa);

  [[nodiscard]] Index item_count() const override { return Index(pairs_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return nodes_[std::size_t(item)];
  }
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override;

 private:
  std::vector<LipPair> pairs_;
  std::vector<std::array<std::int32_t, 2>> nodes_;
  double stiffness_mpa_per_mm_;
  double tone_mpa_;
};

/// Position of the lips relative to each other.
struct LipStatistics {
  double max_overlap_mm = 0.0;   ///< Of -e; 0 if there is none.
  double max_opening_mm = 0.0;   ///< Of e; 0 if there is none.
  double max_slip_mm = 0.0;      ///< Perpendicular to n.
  double closed_fraction = 1.0;  ///< Of the area: e <= kLipsClosed_mm.
};
inline constexpr double kLipsClosed_mm = 0.1;

/// \param lips             with pairs.
/// \param displacement_mm  one per node of the tissue.
[[nodiscard]] LipStatistics lip_statistics(const LipSlit& lips,
                                           std::span<const Vec3> displacement_mm);

}  // namespace lefort::predict
