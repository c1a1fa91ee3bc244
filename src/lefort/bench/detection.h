/// \file
/// Speed of contact detection by distance fields, by our bounding-volume hierarchy and by CGAL's.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>

#include <filesystem>
#include <string>

namespace lefort::bench {

struct DetectionOptions {
  std::filesystem::path ct;      ///< Anything import_volume() reads.
  std::filesystem::path output;  ///< Folder for skull.vtp (reused if present) and detection.md.
  Index points = 50'000;         ///< Within max_distance_mm of the posed skull.
  double max_distance_mm = 2.0;
  int resolution = 256;  ///< Of the field; its band is 5 mm, as in the plans.
  int threads = 2;
  int repeats = 15;  ///< The best counts: disturbances only slow a run.
};

/// Measures depth and normal (by fields also second derivatives) at the same points near a moved
/// skull of 96,190 triangles.
///
/// \param options   of the benchmark.
/// \param progress  may stop it.
/// \returns the table as Markdown; errors as import_volume(), extract_skull(),
///   build_distance_field(), kFileUnwritable.
[[nodiscard]] Result<std::string> run_detection(const DetectionOptions& options,
                                                Progress& progress);

}  // namespace lefort::bench
