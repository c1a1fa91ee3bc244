/// \file
/// The plane of mirror symmetry of a nearly symmetric surface.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/bvh.h>

#include <span>

namespace lefort::geometry {

struct SymmetryPlane {
  Vec3 point = Vec3::Zero();    ///< Of the plane [mm].
  Vec3 normal = Vec3::UnitX();  ///< Unit length; in the direction of the initial normal.
  double rms_mm = 0.0;  ///< Weighted root mean square distance of mirrored points to the surface.
  double inlier_fraction = 0.0;  ///< Mean weight of the points, 0 to 1.
};

/// Mirrors the points, pairs each with the closest point of the surface, fits the plane to the
/// pairs, and repeats: iterated closest points for a reflection.
///
/// The plane of a set of pairs x, y minimizes the sum of w |S x - y|^2, where S is the reflection.
/// The plane passes through the weighted mean g of all x and y. Its normal is the eigenvector of
/// the smallest eigenvalue of the symmetric part of the sum of w (x - g)(y - g)^T
/// \cite combes2008. The iteration converges slowly on smooth surfaces. After ten iterations the
/// distance of S x from the tangent plane at y replaces |S x - y| \cite chen1992. The weights w are
/// Tukey's, with a width proportional to the median distance (at least 1 mm), so that up to half of
/// the points may have no counterpart.
///
/// \param surface  of a head or a bone.
/// \param points   on the surface, 100 or more.
/// \param start    an initial plane, within about 10 degrees.
/// \returns the plane. Without convergence in 60 iterations, the plane of the last one.
/// \note Same bits for any number of threads.
[[nodiscard]] SymmetryPlane fit_symmetry_plane(const Bvh& surface, std::span<const Vec3> points,
                                               const SymmetryPlane& start);

}  // namespace lefort::geometry
