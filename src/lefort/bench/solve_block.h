/// \file
/// `lefort bench solve`: comparison with CalculiX, and growth of time and memory.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/linear/linear_solver.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::bench {

struct SolveOptions {
  std::filesystem::path output;  ///< Folder for solve.md, .csv, .json.
  int threads = 2;
  int repeats = 3;      ///< Runs of each program, in turns; 0 omits the comparison.
  int pair_cells = 16;  ///< Cells per side of the tet10 block that both programs solve.
  int increments = 2;   ///< Of the load of this block and of the large one.
  std::vector<int> growth_cells = {14, 20, 28, 38, 54};  ///< Cells per side of the hex8 blocks.
  bool large = false;                                    ///< Also a block of a million unknowns.
};

/// Runs all measurements, each in a separate process.
///
/// \param options   of the benchmark.
/// \param progress  may stop the benchmark.
/// \returns the tables as Markdown, which are also written to solve.md; errors of
///   solve_in_process() and run_calculix(); kFileUnwritable.
[[nodiscard]] Result<std::string> run_solve_bench(const SolveOptions& options, Progress& progress);

}  // namespace lefort::bench
