/// \file
/// Solves the block of block_problem.h with CalculiX, a widely used finite element program.
#pragma once

#include <lefort/bench/block_problem.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>

#include <cstddef>
#include <filesystem>

namespace lefort::bench {

/// Linear solvers of CalculiX in Debian's package.
enum class CalculixSolver {
  kSpooles,   ///< Direct; the default of ccx.
  kIterative  ///< Conjugate gradients, preconditioned by an incomplete factor.
};

/// Name in the input of ccx.
[[nodiscard]] const char* name_of(CalculixSolver solver);

struct CalculixTask {
  BlockProblem block;
  CalculixSolver solver = CalculixSolver::kSpooles;
  int threads = 2;
  int increments = 1;
  double tolerance = 1e-6;       ///< Relative; of residual forces and displacement corrections.
  std::filesystem::path folder;  ///< For the files of CalculiX, block.*; created if missing.
};

struct CalculixRun {
  double wall_seconds = 0.0;
  std::size_t peak_bytes = 0;
  int iterations = 0;           ///< Number of equation systems solved.
  double max_residual_n = 0.0;  ///< Largest residual force at the end.
  VectorX displacements_mm;     ///< Three per node.
};

/// Writes the input, runs `ccx` and reads its output.
///
/// \param task      to solve.
/// \param progress  may stop the process.
/// \returns the run; or kInvalidArgument if ccx is not installed, kNotConverged if it fails,
///   kFileNotFound or kFileCorrupt if its output is missing or not understood, kFileUnwritable,
///   kCancelled.
[[nodiscard]] Result<CalculixRun> run_calculix(const CalculixTask& task, Progress& progress);

}  // namespace lefort::bench
