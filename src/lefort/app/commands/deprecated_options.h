/// \file
/// Deprecated names of options, accepted for one version with a warning.
#pragma once

#include <CLI/CLI.hpp>

namespace lefort::app {

/// Adds the options of io::deprecated_options(), hidden, to the commands of `cli`, which must
/// already have all other options. An old option accepts the same values as the new one, and sets
/// the new one; both together are
/// a usage error.
void add_deprecated_options(CLI::App& cli);

}  // namespace lefort::app
