/// \file
/// `lefort bench solve`: the solver beside CalculiX, and how its time and memory grow.
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
  int repeats = 3;      ///< Of each of a pair, by turns; 0 leaves CalculiX out.
  int pair_cells = 16;  ///< Of the block of tet10 that both solve.
  int increments = 2;   ///< Of its load.
  std::vector<int> growth_cells = {14, 20, 28, 38, 54};  ///< Of the blocks of hex8.
  bool large = false;                                    ///< Also a block of a million unknowns.
};

/// Runs everything, each measurement in a process of its own.
///
/// \returns the tables as Markdown, which it also writes; errors as run_solve_task() and
///   run_calculix().
[[nodiscard]] Result<std::string> run_solve_bench(const SolveOptions& options, Progress& progress);

}  // namespace lefort::bench
