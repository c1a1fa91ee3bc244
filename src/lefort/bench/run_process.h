/// \file
/// Runs a program and reads what it prints.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <string>
#include <vector>

namespace lefort::bench {

/// Starts arguments[0] and waits. What it prints on stderr goes to ours.
///
/// \returns its stdout; kInvalidArgument if it cannot be started or does not end with 0;
///   kCancelled if `progress` asked to stop, and the program was ended.
[[nodiscard]] Result<std::string> run_process(const std::vector<std::string>& arguments,
                                              Progress& progress);

}  // namespace lefort::bench
