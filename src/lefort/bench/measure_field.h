/// \file
/// Measures one cell of Table 1: time, memory, errors and query rates of a method.
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
  double relative_tolerance = 5e-5;  ///< Fraction of the side.
  double half_band_cells = 3.0;
  double side_mm = 210.0;
  int threads = 1;
  int repeats = 3;               ///< Builds; medians are reported.
  Index query_points = 200'000;  ///< Within kQueryReach_mm of the surface.
  Index error_points = 100'000;
  Index exact_points = 200'000;  ///< Max number of band samples for CGAL; 0: all.
  int parts = 1;                 ///< Subdivisions of triangle edges: parts^2 triangles.
  bool only_build = false;       ///< Without errors and queries.
};

/// Max distance of query points from the surface.
inline constexpr double kQueryReach_mm = 0.5;

/// Runs the task on `skull` and reports, if the method has it: "seconds", "processor_seconds",
/// "retained_bytes", "peak_bytes" (above the memory before), "samples" (known, in the band),
/// "error_mm" {mean, p99, max} and "wrong_signs" between samples, "lattice_error_mm" and
/// "lattice_wrong_signs" at samples, "unknown" (query points without a result), and rates in
/// points a second: "value", "value_and_gradient", "single".
[[nodiscard]] Result<nlohmann::ordered_json> measure_field(const geometry::TriangleMesh& skull,
                                                           const FieldTask& task);

}  // namespace lefort::bench
