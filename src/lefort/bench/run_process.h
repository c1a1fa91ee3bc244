/// \file
/// Runs a program and reads what it prints.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <cstddef>
#include <string>
#include <vector>

namespace lefort::bench {

/// What a program printed, and what it took.
struct ProcessRun {
  std::string output;          ///< Its stdout.
  double seconds = 0.0;        ///< Wall-clock.
  std::size_t peak_bytes = 0;  ///< The most memory it held.
  int exit_code = 0;           ///< Minus the signal that ended it, if one did.
};

/// As run_process(), with time and memory; how it ended is for the caller to judge.
[[nodiscard]] Result<ProcessRun> run_measured_process(const std::vector<std::string>& arguments,
                                                      Progress& progress);

/// Starts arguments[0] and waits. What it prints on stderr goes to ours.
///
/// \returns its stdout; kInvalidArgument if it cannot be started or does not end with 0;
///   kCancelled if `progress` asked to stop, and the program was ended.
[[nodiscard]] Result<std::string> run_process(const std::vector<std::string>& arguments,
                                              Progress& progress);

}  // namespace lefort::bench
