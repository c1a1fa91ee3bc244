/// \file
/// Common options, execution and exit codes of the sub-commands.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace lefort::app {

/// Exit codes of the program.
enum ExitCode : int { kExitDone = 0, kExitFailed = 1, kExitUsage = 2 };

/// Options of all commands, and the exit code.
struct CommandContext {
  int threads = 0;  ///< 0: as many as the machine has.
  bool json = false;
  bool quiet = false;
  std::filesystem::path profile = {};  ///< File for a profile; empty: none.
  bool slicer_progress = false;        ///< Progress on stdout, for 3D Slicer.
  int exit_code = kExitDone;

  /// Runs `work` with progress on stderr, prints its summary on stdout or its error on stderr, and
  /// sets the exit code.
  void run(const std::string& command,
           const std::function<Result<pipeline::Summary>(Progress&)>& work);
};

/// Adds a CT, its labels and its landmarks: the arguments of commands that measure a head.
///
/// \param landmarks_are  help text of --landmarks.
void add_head_files(
    CLI::App& command, std::filesystem::path& ct, std::optional<std::filesystem::path>& labels,
    std::optional<std::filesystem::path>& landmarks,
    const std::string& landmarks_are = "Landmarks; those that are missing are found");

void add_import_command(CLI::App& cli, CommandContext& context);
void add_phantom_command(CLI::App& cli, CommandContext& context);
void add_segment_command(CLI::App& cli, CommandContext& context);
void add_serve_command(CLI::App& cli, CommandContext& context);
void add_field_command(CLI::App& cli, CommandContext& context);
void add_bench_command(CLI::App& cli, CommandContext& context);
void add_landmarks_command(CLI::App& cli, CommandContext& context);
void add_plan_command(CLI::App& cli, CommandContext& context);
void add_airway_command(CLI::App& cli, CommandContext& context);
void add_cephalogram_command(CLI::App& cli, CommandContext& context);
void add_nerve_command(CLI::App& cli, CommandContext& context);
void add_dental_command(CLI::App& cli, CommandContext& context);
void add_compare_command(CLI::App& cli, CommandContext& context);
void add_predict_command(CLI::App& cli, CommandContext& context);
void add_run_command(CLI::App& cli, CommandContext& context);
void add_solve_command(CLI::App& cli, CommandContext& context);
void add_calibrate_command(CLI::App& cli, CommandContext& context);
void add_uncertainty_command(CLI::App& cli, CommandContext& context);
void add_validate_command(CLI::App& cli, CommandContext& context);
void add_verify_command(CLI::App& cli, CommandContext& context);

}  // namespace lefort::app
