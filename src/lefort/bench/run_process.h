/// \file
/// Runs a program and reads its output.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <cstddef>
#include <string>
#include <vector>

namespace lefort::bench {

/// Output, time and memory of a program.
struct ProcessRun {
  std::string output;          ///< Its stdout.
  double seconds = 0.0;        ///< Wall-clock.
  std::size_t peak_bytes = 0;  ///< Max resident memory.
  int exit_code = 0;           ///< Negative: minus the number of the signal that ended it.
};

/// As run_process() below, with time and memory; a nonzero exit code is no error.
[[nodiscard]] Result<ProcessRun> run_measured_process(const std::vector<std::string>& arguments,
                                                      Progress& progress);

/// Starts the program at the path arguments[0] and waits. Its stderr is that of this process.
///
/// \returns its stdout; kInvalidArgument if it cannot be started or its exit code is not 0;
///   kCancelled if `progress` requested a stop; the program was then terminated.
[[nodiscard]] Result<std::string> run_process(const std::vector<std::string>& arguments,
                                              Progress& progress);

}  // namespace lefort::bench
