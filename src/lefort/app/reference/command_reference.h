/// \file
/// The command line as data: the source of manual pages, completion in a shell and the description
/// for 3D Slicer.
#pragma once

#include <lefort/app/commands/path_kind.h>

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::app {

/// An option or a positional argument.
struct OptionReference {
  std::vector<std::string> names;  ///< With hyphens, short ones first; empty: only positional.
  std::string positional;          ///< Name as a positional argument; empty: it is an option only.
  std::string description;
  std::string group;                 ///< Heading of the help text; "Options" unless set.
  std::string value;                 ///< Name of the value: TEXT, INT, FOLDER, ...; empty: a flag.
  std::string default_text;          ///< Value if it is not given; empty: none.
  std::vector<std::string> choices;  ///< The values accepted; empty: any.
  std::optional<std::pair<double, double>> range;  ///< Minimum and maximum of a number.
  bool is_required = false;
  bool is_many = false;       ///< Accepts several values.
  bool has_relation = false;  ///< Needs or excludes another option.
  const PathTraits* path = nullptr;

  [[nodiscard]] bool is_flag() const { return value.empty(); }
  /// The first long name without hyphens; empty if there is none.
  [[nodiscard]] std::string long_name() const;
};

/// A command, or the program itself.
struct CommandReference {
  std::vector<std::string> words;  ///< "lefort", "plan", "check".
  std::string description;
  std::vector<std::string> notes;     ///< Sentences of the footer, a paragraph each.
  std::vector<std::string> examples;  ///< Command lines; one may have several lines.
  std::vector<OptionReference> options;
  std::vector<CommandReference> commands;  ///< Nested commands.

  /// The words, joined.
  [[nodiscard]] std::string joined(const std::string& separator) const;
};

/// Words with a separator between them.
[[nodiscard]] std::string join_words(const std::vector<std::string>& words,
                                     const std::string& separator = " ");

/// Describes a program or command and its nested commands. Hidden options (of the group "") and
/// hidden commands are left out, and so is --help.
///
/// \param app     the program or command; not changed.
/// \param parent  words of the command that it belongs to.
[[nodiscard]] CommandReference describe_command(CLI::App& app,
                                                std::vector<std::string> parent = {});

}  // namespace lefort::app
