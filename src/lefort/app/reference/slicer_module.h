/// \file
/// Commands as command line modules of 3D Slicer, which makes a panel from an XML description.
#pragma once

#include <lefort/app/reference/command_reference.h>
#include <lefort/core/error.h>

#include <string>
#include <vector>

namespace lefort::app {

/// A command that is a module.
struct SlicerModule {
  std::vector<std::string> words;  ///< "plan", "check".
  std::string title;               ///< In the list of modules.
};

/// All modules.
[[nodiscard]] const std::vector<SlicerModule>& slicer_modules();

/// The description of a command in the Slicer Execution Model: the XML that a module prints for
/// `--xml` (contract/slicer_module.xsd).
///
/// Numbers and choices without a default, and options that need or exclude another, become texts:
/// 3D Slicer gives each number and choice to the program, also if the user has not set it, but
/// leaves empty texts out.
///
/// \param command  the command.
/// \param program  the program; its option --threads becomes an advanced parameter.
/// \returns the XML; kInvalidArgument if the command is no module, with the names of all modules.
[[nodiscard]] Result<std::string> slicer_description(const CommandReference& command,
                                                     const CommandReference& program);

/// A script of sh that 3D Slicer runs as the module.
[[nodiscard]] std::string slicer_wrapper(const SlicerModule& module);

}  // namespace lefort::app
