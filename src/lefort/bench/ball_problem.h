/// \file
/// A rigid ball that is pressed into a block of soft tissue and slides along it: a benchmark of
/// contact.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::bench {

/// The block is 40 x 40 x 20 mm, fixed at its lower side; the ball has a radius of 10 mm. Contact
/// has no friction.
struct BallProblem {
  static constexpr double kRadius_mm = 10.0;
  static constexpr double kPressed_mm = 5.0;  ///< Downwards, first.
  static constexpr double kSlid_mm = 16.0;    ///< Along x, then.
  static constexpr int kPressIncrements = 10, kSlideIncrements = 16;
  static constexpr double kC10_mpa = 0.005;  ///< Of Psi = c10 (J^(-2/3) I1 - 3)
  static constexpr double kKappa_mpa = 1.0;  ///< + kappa/2 (J - 1)^2.

  /// Sets of block().
  static constexpr const char* kBelow = "z0";
  static constexpr const char* kAbove = "z1";

  /// 16 x 16 x 8 hex8.
  [[nodiscard]] static mesh::VolumeMesh block();

  /// The ball touches the block 8 mm beside the middle of its upper side.
  [[nodiscard]] static Vec3 center_mm() { return {12.0, 20.0, 30.0}; }

  /// An icosahedron with edges halved `halvings` times; vertices on the sphere.
  /// \pre 0 <= halvings <= 6
  [[nodiscard]] static geometry::TriangleMesh ball(int halvings);

  [[nodiscard]] static geometry::RigidPath path();
};

}  // namespace lefort::bench
