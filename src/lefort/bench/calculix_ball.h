/// \file
/// Solves the contact problem of ball_problem.h with CalculiX.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>

#include <filesystem>

namespace lefort::bench {

/// Formulations of contact in CalculiX; all by a linear pressure over the penetration.
enum class CalculixContact {
  kNodeToSurface,  ///< Penalty at the nodes of the block.
  kMortar          ///< By weighted integrals over the faces.
};

/// Name in the input of ccx.
[[nodiscard]] const char* name_of(CalculixContact contact);

struct CalculixBallTask {
  CalculixContact contact = CalculixContact::kNodeToSurface;
  double stiffness_mpa_per_mm = 0.12;  ///< Of contact, > 0.
  int halvings = 4;                    ///< Of the ball's edges.
  int threads = 2;
  double tolerance = 1e-8;       ///< Relative; of residual forces and displacement corrections.
  std::filesystem::path folder;  ///< For the files of CalculiX, ball.*; created if missing.
};

struct CalculixBallRun {
  double wall_seconds = 0.0;
  int iterations = 0;      ///< Number of equation systems solved.
  int increments = 0;      ///< Converged; CalculiX divides one that does not converge.
  double force_z_n = 0.0;  ///< Of the ball on the block at the end.
};

/// Writes the input, runs `ccx` and reads its output.
///
/// \returns the run; kInvalidArgument if ccx is not installed, kNotConverged if it fails;
///   kFileNotFound or kFileCorrupt if its output is missing or not understood,
///   kFileUnwritable, kCancelled.
[[nodiscard]] Result<CalculixBallRun> run_calculix_ball(const CalculixBallTask& task,
                                                        Progress& progress);

}  // namespace lefort::bench
