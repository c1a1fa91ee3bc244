/// \file
/// Repeats Table 1 of the paper: time and memory of distance fields of a skull, compared with
/// current libraries.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::bench {

struct Table1Options {
  std::filesystem::path ct;      ///< Anything import_volume() reads.
  std::filesystem::path output;  ///< Folder for skull, table and plots.
  std::vector<int> resolutions = {128, 256, 512};
  std::vector<std::string> methods = {"bricks",  "hybrid", "adaptive", "uniform",
                                      "openvdb", "embree", "cgal"};
  int repeats = 3;  ///< Builds of each method, except one of adaptive and of cgal.
};

/// Runs each method at each resolution in a separate process, bricks also with two threads.
///
/// Writes skull.vtp (reused if it exists), table1.json, .csv, .md and .html (plots)
/// to the output folder. The figures of the paper, of 2009 hardware, are listed separately.
/// \returns the table as Markdown; errors of prepare_skull() and measure_in_process();
///   kFileUnwritable.
[[nodiscard]] Result<std::string> run_table1(const Table1Options& options, Progress& progress);

}  // namespace lefort::bench
