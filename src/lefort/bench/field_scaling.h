/// \file
/// Growth of time and memory of a field with its band, resolution and triangles.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::bench {

struct ScalingOptions {
  std::filesystem::path ct;                              ///< Anything import_volume() reads.
  std::filesystem::path output;                          ///< Folder for skull, tables and plots.
  std::vector<int> bands = {2, 3, 4, 6, 8, 12, 16, 24};  ///< Half widths in cells, at 256^3.
  std::vector<int> resolutions = {64, 128, 256, 512, 1024, 2048};  ///< With a band of 3 cells.
  std::vector<int> parts = {1, 2, 4, 8, 11};  ///< Parts of each triangle edge, at 256^3.
  bool with_openvdb = true;  ///< For comparison, up to 1024^3 and 1.5 million triangles.
  int repeats = 3;           ///< Builds by lefort; OpenVDB builds once.
};

/// Builds fields with one thread, each configuration in a separate process. Writes skull.vtp,
/// scaling.json, .csv, .md and .html to the output folder. Exponents are slopes of least-squares
/// lines through the logarithms.
///
/// \returns the tables as Markdown; errors as those of run_table1().
[[nodiscard]] Result<std::string> run_field_scaling(const ScalingOptions& options,
                                                    Progress& progress);

}  // namespace lefort::bench
