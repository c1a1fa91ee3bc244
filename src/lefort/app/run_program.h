/// \file
/// The command line of lefort.
#pragma once

namespace lefort::app {

/// Parses the command line and runs the command.
/// \returns the exit code: 0 done; 1 failed (one line on stderr states why), or done with findings
///   or failed checks (`plan check`, `verify`); 2 wrong usage.
[[nodiscard]] int run_program(int argc, char** argv);

}  // namespace lefort::app
