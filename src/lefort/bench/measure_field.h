/// \file
/// Measures one method at one resolution for Table 1: time, memory, errors and query rates.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

#include <nlohmann/json.hpp>

#include <string>

namespace lefort::bench {

/// What one process measures. Each configuration has a separate process, so that memory is separate
/// and caches are cold.
struct FieldTask {
  std::string method;  ///< bricks, hybrid, adaptive, uniform, openvdb, embree, cgal.
  int resolution = 128;
  double relative_tolerance = 5e-5;  ///< Of samples, as a fraction of the side.
  double half_band_cells = 3.0;
  double side_mm = 210.0;
  int threads = 1;
  int repeats = 3;               ///< Number of builds; medians are reported.
  Index query_points = 200'000;  ///< Number, within kQueryReach_mm of the surface.
  Index error_points = 100'000;  ///< Likewise.
  Index exact_points = 200'000;  ///< Max number of band samples for CGAL; 0: all.
  /// Parts of each triangle edge: parts^2 triangles per triangle. Applied by run_field_task().
  int parts = 1;
  bool only_build = false;  ///< Without errors and queries; embree and cgal ignore it.
};

/// Max distance of query points from the surface.
inline constexpr double kQueryReach_mm = 0.5;

/// Runs the task on `skull`.
///
/// \returns, as far as the method has them: "seconds" (of the build; for CGAL and Embree with the
///   query of all samples), "processor_seconds", "retained_bytes",
///   "peak_bytes" (above the memory before the first build), "tolerance_mm", "triangles",
///   "samples" (in the band) and "samples_asked" (of these, by CGAL and Embree), "error_mm"
///   {mean, p99, max} and "wrong_signs" between samples, "unknown" (points of these errors without
///   a result), "lattice_error_mm" and "lattice_wrong_signs" at samples, and "rates"
///   {value, value_and_gradient, single} in points per second; or kInvalidArgument for an unknown
///   method, or an error of field::build_distance_field().
[[nodiscard]] Result<nlohmann::ordered_json> measure_field(const geometry::TriangleMesh& skull,
                                                           const FieldTask& task);

}  // namespace lefort::bench
