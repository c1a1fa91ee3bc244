/// \file
/// How a printed body fits on teeth or bone.
#pragma once

#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/geometry/bvh.h>

#include <vector>

namespace lefort::dental {

/// Distances of a base, teeth or bone, from the body that is put on it.
struct InsertionFit {
  /// Distance of the covered vertices from the body [mm]; negative: inside. NaN without any.
  double p5_mm = 0.0, median_mm = 0.0, p95_mm = 0.0;
  /// Deepest penetration of a vertex of the base into the body, at the end and on the way of 10 mm
  /// in [mm].
  double max_penetration_mm = 0.0;
};

/// \param base       the surface of teeth or bone.
/// \param body       closed.
/// \param covered    for each vertex of the base: whether its distance counts.
/// \param removal    unit vector in which the body is taken off.
/// \param progress   may cancel; the result then is not complete.
[[nodiscard]] InsertionFit insertion_fit(const geometry::TriangleMesh& base,
                                         const geometry::Bvh& body,
                                         const std::vector<char>& covered, const Vec3& removal,
                                         const Progress& progress = Progress::none());

/// \param part  0 to 1.
/// \returns the value below which that part of the values lies; NaN is left out, and returned if
///   nothing is left.
[[nodiscard]] double percentile(std::vector<double> values, double part);

}  // namespace lefort::dental
