/// \file
/// Culling of contact patches: a patch that was far from contact and has moved little since needs
/// no distance query.
///
/// A distance is 1-Lipschitz: |g(x) - g(y)| <= |x - y|. Let c be the clearance of a patch: the min
/// of g - max(g_0, 0) over its points, with the rest gap g_0, at nodal positions y_a in the frame
/// of the bone. A point sum N_a x_a moves by at most (max_a |x_a - y_a|) sum |N_a|. So no point is
/// in contact while
///
///   max_a |x_a - y_a| < (c - slack) / (L max sum |N_a|)
///
/// where slack and L account for the errors of a sampled distance and of its gradient.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lefort::contact {

class ContactClearance {
 public:
  /// \param patches  number of patches; none has a clearance yet.
  explicit ContactClearance(std::size_t patches) : patches_(patches) {}

  /// \param x_L           nodes of the patch [mm]; the bone is at its present pose.
  /// \param clearance_mm  c.
  void record(std::size_t patch, const RigidObstacle& obstacle, std::span<const Vec3> x_L,
              double clearance_mm);

  /// \param x_L                 nodes of the patch [mm]; the bone is at its present pose.
  /// \param displacement_bound  FaceQuadrature::displacement_bound.
  /// \returns whether no point of the patch can be in contact.
  [[nodiscard]] bool is_out_of_range(std::size_t patch, const RigidObstacle& obstacle,
                                     std::span<const Vec3> x_L, double displacement_bound) const;

 private:
  struct Patch {
    std::array<Vec3, 8> nodes_B;
    double clearance_mm = 0.0;
  };
  std::vector<Patch> patches_;
};

}  // namespace lefort::contact
