/// \file
/// Completion in bash.
#pragma once

#include <lefort/app/reference/command_reference.h>

#include <string>

namespace lefort::app {

/// A script for bash that completes commands, options, choices of values, and paths by extension.
/// It needs nothing but bash 4.
///
/// \param program  the program with all its commands.
[[nodiscard]] std::string bash_completion(const CommandReference& program);

}  // namespace lefort::app
