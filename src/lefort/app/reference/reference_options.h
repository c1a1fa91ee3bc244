/// \file
/// Options that print or write what programs read about the command line.
#pragma once

#include <lefort/app/commands/command.h>

#include <CLI/CLI.hpp>

namespace lefort::app {

/// Adds --man, --xml, --bash-completion, and --write-reference to the program, which must already
/// have all its commands. They apply to the command on the command line and end the program before
/// anything is checked or run.
void add_reference_options(CLI::App& cli);

}  // namespace lefort::app
