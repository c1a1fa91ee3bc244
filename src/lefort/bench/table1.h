/// \file
/// The paper's Table 1 rerun: time and memory of distance fields of a skull, beside today's peers.
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
  int repeats = 3;
};

/// Runs each method at each resolution in a process of its own, bricks with two threads as well.
///
/// Writes skull.vtp (kept and used again if it is there), table1.json, .csv, .md and .html (plots)
/// to the output folder. The paper's own figures, of 2009 hardware, stand apart.
/// \returns the table as Markdown; errors as import_volume(), extract_skull(), kFileUnwritable,
///   kCancelled.
[[nodiscard]] Result<std::string> run_table1(const Table1Options& options, Progress& progress);

}  // namespace lefort::bench
