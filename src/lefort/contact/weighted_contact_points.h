/// \file
/// Parts of WeightedContactTerm that its source files have in common.
#pragma once

#include <lefort/contact/point_in_patch.h>
#include <lefort/contact/weighted_contact_term.h>

#include <limits>
#include <vector>

namespace lefort::contact {

/// \param all_L  positions of all nodes of the mesh.
/// \returns those of the patch.
[[nodiscard]] inline std::vector<Vec3> positions(const NodePatch& patch,
                                                 std::span<const Vec3> all_L) {
  std::vector<Vec3> x_L;
  for (const std::int32_t n : patch.nodes) x_L.push_back(all_L[std::size_t(n)]);
  return x_L;
}

/// g_a and its derivatives.
struct WeightedContactTerm::PatchGap {
  double gap_mm = 0.0;  ///< g_a.
  /// G_a, three per node.
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3 * kMaxPatchNodes, 1> gradient_mm2;
};

template <class Function>
void WeightedContactTerm::for_each_point_behind(const std::vector<PointsWithRest>& points,
                                                std::size_t patch, std::span<const Vec3> x_L,
                                                bool wants_hessian, const Function& f,
                                                double max_depth_factor) const {
  const double max_depth_mm = max_depth_factor * max_depth_mm_[patch];
  std::vector<PatchTriangle> triangles;  // Only if there is a point.
  const auto visit = [&](std::size_t bone, std::size_t v) {
    if (triangles.empty()) triangles = triangles_of(patches_[patch], x_L);
    const RigidTransform& X_LB = obstacles_[bone].X_LB;
    const BonePoints& of_bone = points[bone].points;
    const auto depth =
        point_depth(patches_[patch], triangles,
                    {X_LB * of_bone.points_B()[v], X_LB.linear() * of_bone.normals_B()[v]},
                    max_depth_mm, wants_hessian);
    if (depth && depth->depth_mm > points[bone].rest_depths_mm[v]) f(bone, v, *depth);
  };
  const bool is_noted = &points == &sharp_points_;
  for (std::size_t bone = 0; bone < obstacles_.size(); ++bone) {
    const BonePoints& of_bone = points[bone].points;
    if (of_bone.points_B().empty()) continue;
    const double moved_mm =
        is_noted ? moved_since_note_mm(bone, patch, x_L) : std::numeric_limits<double>::infinity();
    if (max_depth_mm + moved_mm < clearances_.points.range_mm()) {
      for (const PointCandidate& near : clearances_.points.of(patch))
        if (near.bone == bone && near.in_front_mm <= moved_mm &&
            near.distance_mm - moved_mm < max_depth_mm)
          visit(bone, near.point);
      continue;
    }
    const RigidTransform X_BL = obstacles_[bone].X_LB.inverse();
    Box3 box_B;
    for (const Vec3& x : x_L) box_B.extend(X_BL * x);
    const Vec3 margin = Vec3::Constant(max_depth_mm);
    of_bone.for_each_in(Box3(box_B.min() - margin, box_B.max() + margin),
                        [&](std::size_t v) { visit(bone, v); });
  }
}

}  // namespace lefort::contact
