/// \file
/// One measurement of lefort's solver on a block, in a separate process.
#pragma once

#include <lefort/bench/block_problem.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/linear/linear_solver.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace lefort::bench {

struct SolveTask {
  BlockProblem block;
  linear::LinearSolverKind solver = linear::LinearSolverKind::kAutomatic;
  int threads = 2;
  /// Planned number; an increment that fails is halved. 0: only one linear system, that of the
  /// block at rest for a small motion of its upper side.
  int increments = 1;
  double load = 1.0;                      ///< Fraction of the full load, > 0 and <= 1.
  double relative_tolerance = 1e-8;       ///< Of Newton's method; the one linear system has 1e-8.
  std::filesystem::path displacements{};  ///< Output file of doubles; or empty.
};

/// The name of a solver in options and results.
[[nodiscard]] const char* name_of(linear::LinearSolverKind kind);

[[nodiscard]] nlohmann::ordered_json to_json(const SolveTask& task);

/// Runs the task.
///
/// \param task  as to_json() writes it.
/// \returns dofs, seconds of the parts of the task, iterations, peak_bytes and more; kNotConverged,
///   kOutOfMemory, kInvalidArgument, kFileUnwritable.
[[nodiscard]] Result<nlohmann::ordered_json> run_solve_task(const std::string& task);

/// Runs the task in a separate process and adds wall_seconds of the process.
/// \returns the result of run_solve_task(); kInvalidArgument if the process cannot be started or
///   its exit code is not 0, kFileCorrupt if it printed no JSON, kCancelled.
[[nodiscard]] Result<nlohmann::ordered_json> solve_in_process(const SolveTask& task,
                                                              Progress& progress);

}  // namespace lefort::bench
