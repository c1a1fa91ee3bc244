/// \file
/// How fast contact detection answers, by fields, by our tree of boxes and by CGAL's.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>

#include <filesystem>
#include <string>

namespace lefort::bench {

struct DetectionOptions {
  std::filesystem::path ct;      ///< Anything import_volume() reads.
  std::filesystem::path output;  ///< Folder for skull.vtp (used again if there) and detection.md.
  Index points = 50'000;         ///< Within reach_mm of the bone, as moved.
  double reach_mm = 2.0;
  int resolution = 256;  ///< Of the field; its band is 5 mm, as in the plans.
  int threads = 2;
  int repeats = 15;  ///< The best is told: what disturbs a run only slows it.
};

/// Asks for depth and normal (and by fields the second derivatives, too) of the same points of a
/// moved skull of 96,190 triangles.
///
/// \returns the table as Markdown; errors as import_volume(), extract_skull(),
///   build_distance_field(), kFileUnwritable.
[[nodiscard]] Result<std::string> run_detection(const DetectionOptions& options,
                                                Progress& progress);

}  // namespace lefort::bench
