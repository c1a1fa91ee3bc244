/// \file
/// Bone overlap as a penalty with derivatives, and as a limit.
///
/// A vertex p of one bone lies at the depth d = -g in another bone, g: signed distance. With the
/// velocities v of both bones, dd/dq = -grad g . (v_1(p) - v_2(p)).
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/predict/bone_overlap_at_fraction.h>
#include <lefort/predict/face_response.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::inverse {

/// Depth of one vertex beyond the penalty's threshold.
struct OverlapRow {
  double excess_mm = 0.0;  ///< > 0.
  VectorX derivative;      ///< By each number; empty if not computed.
};

/// The deepest overlap of two bones.
struct DeepestOverlap {
  double depth_mm = 0.0;
  bool is_lower_bound = false;  ///< Deeper than the range of a distance query.
  std::string first, second;    ///< Names; empty without overlap.
};

class BoneClearance {
 public:
  /// \param bones       segments in the order of the plan, then stationary bone; their paths are
  ///   not used. Surfaces must outlive the object.
  /// \param allowed_mm  limit of the depth, >= 0.
  BoneClearance(std::vector<predict::MovingBone> bones, double allowed_mm);

  [[nodiscard]] double allowed_mm() const { return allowed_mm_; }

  /// \param X_LB   pose of each segment.
  /// \param rates  motions by each number; empty: no derivatives.
  /// \returns the vertices deeper than kThreshold of the limit, in a fixed order.
  [[nodiscard]] std::vector<OverlapRow> rows(std::span<const RigidTransform> X_LB,
                                             std::span<const predict::PoseRate> rates) const;

  /// Whether no overlap is deeper than the limit. An overlap beyond the range of a distance query
  /// is, whatever the limit.
  [[nodiscard]] bool is_within(const DeepestOverlap& overlap) const {
    return !overlap.is_lower_bound && overlap.depth_mm <= allowed_mm_;
  }

  /// Deepest overlap of all pairs by contact::measure_overlap(), which also tests edges.
  [[nodiscard]] DeepestOverlap deepest(std::span<const RigidTransform> X_LB) const;

  static constexpr double kThreshold = 0.8;

 private:
  [[nodiscard]] RigidTransform pose(std::size_t bone, std::span<const RigidTransform> X_LB) const;

  std::vector<predict::MovingBone> bones_;
  double allowed_mm_;
};

}  // namespace lefort::inverse
