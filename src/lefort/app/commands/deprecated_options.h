/// \file
/// Deprecated names of options, accepted for one version with a warning.
#pragma once

#include <CLI/CLI.hpp>

namespace lefort::app {

/// Adds the options of io::deprecated_options(), hidden, to the commands of `cli`, which must have
/// all others. Each takes what its new name takes; both together are a usage error.
void add_deprecated_options(CLI::App& cli);

}  // namespace lefort::app
