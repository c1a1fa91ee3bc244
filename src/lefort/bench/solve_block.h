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
  int repeats = 3;      ///< Of each program, in turns; 0 omits CalculiX.
  int pair_cells = 16;  ///< Of the tet10 block for both.
  int increments = 2;   ///< Of its load.
  std::vector<int> growth_cells = {14, 20, 28, 38, 54};  ///< Of the blocks of hex8.
  bool large = false;                                    ///< Also a block of a million unknowns.
};

/// Runs all measurements, each in a separate process.
///
/// \param options   of the benchmark.
/// \param progress  may stop it.
/// \returns the tables as Markdown, which it also writes; errors as run_solve_task() and
///   run_calculix().
[[nodiscard]] Result<std::string> run_solve_bench(const SolveOptions& options, Progress& progress);

}  // namespace lefort::bench
