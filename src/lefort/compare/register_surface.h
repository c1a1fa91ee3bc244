/// \file
/// Lays one surface onto another that shows the same object, wholly or in part.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <vector>

namespace lefort::compare {

struct RegisterOptions {
  Index max_points = 20000;  ///< Vertices that take part in the last iterations; >= 100.
  int max_iterations = 200;  ///< >= 1.
  /// Half of the points must come to lie nearer than this; > 0. Bone in two scans of one patient
  /// lies within parts of a voxel.
  double max_median_mm = 1.5;
};

struct Registration {
  RigidTransform X_onto_from = RigidTransform::Identity();
  double rms_mm = 0.0;  ///< Of what distances remain, weighted as below.
  double inlier_fraction =
      0.0;  ///< Mean weight, 0 to 1: what of the surface found its counterpart.
  /// How firmly the least firm of the six motions is held: the mean square of its part along the
  /// normals, 0 for a motion that leaves the surface in itself, as a turn does a ball.
  double stability = 0.0;
};

/// Brings `from` onto `onto` by iterated closest points, minimizing distances along the normals
/// \cite chen1992 with Tukey's weights, whose width follows the median distance: up to half of
/// `from` may have no counterpart. Never a mirror image.
///
/// \param from    vertices that lie on the object; all of its vertices are used, or every n-th.
/// \param onto    the surface they are laid onto; closed or open.
/// \param starts  where to begin, one or more; each is followed with few points, and the one that
///   ends nearest (by the median distance; the earliest of equals) with all.
/// \returns the motion, or
///   - kInvalidArgument  fewer than 100 vertices, an option out of range, no start;
///   - kNotConverged     the iterations do not settle, fewer than a third of the points find a
///     counterpart, half of them stay further off than asked, or a motion is not held at all
///     (firmness below 1e-4);
///   - kCancelled.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<Registration> register_surface(const geometry::TriangleMesh& from,
                                                    const geometry::Bvh& onto,
                                                    std::span<const RigidTransform> starts,
                                                    const RegisterOptions& options = {},
                                                    Progress& progress = Progress::none());

/// Starts for two scans of one head whose frames have nothing to do with each other: as it is, by
/// the centers, and by the centers and principal axes in the four ways that are rotations.
[[nodiscard]] std::vector<RigidTransform> initial_alignments(const geometry::TriangleMesh& from,
                                                             const geometry::TriangleMesh& onto);

}  // namespace lefort::compare
