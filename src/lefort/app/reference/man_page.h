/// \file
/// Manual pages.
#pragma once

#include <lefort/app/reference/command_reference.h>

#include <string>

namespace lefort::app {

/// A manual page in the macros of man(7), section 1.
///
/// \param command  the command that the page describes.
/// \param program  the program; the command itself for the page of the program.
/// \returns the text, without a date: the same program gives the same bytes.
[[nodiscard]] std::string man_page(const CommandReference& command,
                                   const CommandReference& program);

}  // namespace lefort::app
