/// \file
/// Rigid registration of two surfaces of the same object, or of parts of it.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <vector>

namespace lefort::compare {

struct RegisterOptions {
  Index max_points = 20000;  ///< Max number of vertices used in the last iterations; >= 100.
  int max_iterations = 200;  ///< >= 1; the last step must be below 0.01 mm.
  /// Max median of the distances after registration; > 0. The bone in two scans of one patient
  /// agrees within a fraction of a voxel.
  double max_median_mm = 1.5;
};

struct Registration {
  RigidTransform X_onto_from = RigidTransform::Identity();
  double rms_mm = 0.0;           ///< Weighted root mean square of the remaining distances.
  double inlier_fraction = 0.0;  ///< Mean weight of the points, 0 to 1.
  /// Smallest eigenvalue of the normal matrix over the six rigid-body motions, relative to the sum
  /// of weights: the mean square displacement along the normals by the unit motion that the
  /// surfaces determine least. It is 0 if a motion maps the surface to itself, such as a rotation
  /// of a sphere (Gelfand et al. 2003).
  double stability = 0.0;
};

/// Registers `from` with `onto` by iterated closest points with point-to-plane distances
/// \cite chen1992 and Tukey's weights, whose width follows the median distance: up to half of
/// `from` may have no counterpart. The motion is never a reflection.
///
/// \param from      vertices that lie on the object; every n-th is used, so that there are at most
///   options.max_points.
/// \param onto      the surface to register with; closed or open.
/// \param starts    initial alignments, one or more. Each is iterated with few points; the one of
///   the smallest median distance (the first of equals) is continued with up to
///   options.max_points points.
/// \param options   points, iterations and the acceptable distance.
/// \param progress  receives the fraction done; may request a stop.
/// \returns the motion, or
///   - kInvalidArgument  fewer than 100 vertices have a normal, an option is out of range, or there
///     is no initial alignment;
///   - kNotConverged     the iterations do not converge, half of the points or more have no
///     counterpart, the inlier fraction is below 1/3, the median distance exceeds
///     options.max_median_mm, or the surfaces do not determine the motion (stability below 1e-4);
///   - kCancelled        `progress` requested a stop.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<Registration> register_surface(const geometry::TriangleMesh& from,
                                                    const geometry::Bvh& onto,
                                                    std::span<const RigidTransform> starts,
                                                    const RegisterOptions& options = {},
                                                    Progress& progress = Progress::none());

/// Initial alignments for two scans of one head in unrelated frames.
///
/// \param from, onto  as for register_surface().
/// \returns the identity, the translation between the centroids, and the four rotations that align
///   the principal axes.
[[nodiscard]] std::vector<RigidTransform> initial_alignments(const geometry::TriangleMesh& from,
                                                             const geometry::TriangleMesh& onto);

}  // namespace lefort::compare
