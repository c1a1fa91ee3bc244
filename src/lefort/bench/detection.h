/// \file
/// Speed of contact detection by distance fields, by lefort's bounding-volume hierarchy (BVH) and
/// by CGAL's AABB tree.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>

#include <filesystem>
#include <string>

namespace lefort::bench {

struct DetectionOptions {
  std::filesystem::path ct;      ///< Anything import_volume() reads.
  std::filesystem::path output;  ///< For skull.vtp (reused if present), detection.md and .json.
  Index points = 50'000;         ///< Number, within max_distance_mm of the moved skull.
  double max_distance_mm = 2.0;
  int resolution = 256;  ///< Of the field; its band is 5 mm, as in examples/midface_forward.json.
  int threads = 2;
  int repeats = 15;  ///< The fastest is reported: disturbances only slow a run.
};

/// Measures the time of queries of distance and normal at the same points near a moved skull of
/// 96,190 triangles, and the error of the distance. Fields are measured without and with the
/// Hessian; CGAL returns the distance only.
///
/// \param options   of the benchmark.
/// \param progress  may stop the benchmark.
/// \returns the table as Markdown; errors of prepare_skull(), io::read_surface() and
///   field::build_distance_field(); kFileUnwritable.
[[nodiscard]] Result<std::string> run_detection(const DetectionOptions& options,
                                                Progress& progress);

}  // namespace lefort::bench
