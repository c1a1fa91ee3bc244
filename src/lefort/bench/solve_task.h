/// \file
/// One measurement of our solver on a block, in a process of its own.
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
  /// Of the load, as long as they converge; halved where not. None: one linear system, that of the
  /// block at rest, with the forces of its upper side's motion.
  int increments = 1;
  double load = 1.0;                      ///< Part of it, 0 to 1.
  double relative_tolerance = 1e-8;       ///< Of Newton; of the linear system, 1e-8 always.
  std::filesystem::path displacements{};  ///< Where they are to be written, as doubles; or empty.
};

/// The name of a solver in options and results.
[[nodiscard]] const char* name_of(linear::LinearSolverKind kind);

[[nodiscard]] nlohmann::ordered_json to_json(const SolveTask& task);

/// Does the task.
///
/// \param task  as to_json() writes it.
/// \returns dofs, seconds of its parts, iterations, peak_bytes and more; kNotConverged,
///   kOutOfMemory, kInvalidArgument, kFileUnwritable.
[[nodiscard]] Result<nlohmann::ordered_json> run_solve_task(const std::string& task);

/// Does it in a process of its own, and adds that one's wall_seconds.
[[nodiscard]] Result<nlohmann::ordered_json> solve_in_process(const SolveTask& task,
                                                              Progress& progress);

}  // namespace lefort::bench
