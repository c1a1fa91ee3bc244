#include <lefort/app/reference/command_reference.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace lefort::app {
namespace {

/// Descriptions of the validators of an option.
std::vector<std::string> validators_of(CLI::Option& option) {
  std::vector<std::string> descriptions;
  try {
    for (int index = 0;; ++index)
      descriptions.push_back(option.get_validator(index)->get_description());
  } catch (const CLI::OptionNotFound&) {
    return descriptions;  // How CLI11 reports that there is no further one.
  }
}

/// "{a,b}" as CLI::IsMember writes it.
std::vector<std::string> choices_of(const std::string& text) {
  std::vector<std::string> choices;
  if (text.size() < 2 || text.front() != '{' || text.back() != '}') return choices;
  std::istringstream inside(text.substr(1, text.size() - 2));
  for (std::string choice; std::getline(inside, choice, ',');) choices.push_back(choice);
  return choices;
}

/// "INT in [1 - 20]" as CLI::Range writes it.
std::optional<std::pair<double, double>> range_of(const std::string& text) {
  const std::size_t open = text.find(" in [");
  const std::size_t dash = text.find(" - ", open);
  if (open == std::string::npos || dash == std::string::npos) return {};
  return std::pair(std::strtod(text.c_str() + open + 5, nullptr),
                   std::strtod(text.c_str() + dash + 3, nullptr));
}

OptionReference describe_option(CLI::Option& option) {
  OptionReference found;
  for (const std::string& name : option.get_snames()) found.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) found.names.push_back("--" + name);
  if (option.get_positional()) found.positional = option.get_name(true);
  found.description = option.get_description();
  found.group = option.get_group();
  found.default_text = option.get_default_str();
  found.is_required = option.get_required();
  found.has_relation = !option.get_needs().empty() || !option.get_excludes().empty();
  found.is_many = option.get_items_expected_max() > 1;
  found.path = path_traits(option);
  if (option.get_type_size() == 0) return found;  // A flag.
  const std::string type = option.get_type_name();
  found.value = type.substr(0, type.find(':'));
  for (const std::string& text : validators_of(option)) {
    if (found.choices.empty()) found.choices = choices_of(text);
    if (!found.range) found.range = range_of(text);
  }
  return found;
}

/// The footer has paragraphs, and examples: lines indented by two spaces, continued by deeper ones.
void add_footer(const std::string& footer, CommandReference& command) {
  std::istringstream lines(footer);
  bool in_note = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "Example:" || line == "Examples:" || line.empty()) {
      in_note = false;
    } else if (line.starts_with("    ") && !command.examples.empty()) {
      command.examples.back() += "\n" + line.substr(2);
    } else if (line.starts_with("  ")) {
      command.examples.push_back(line.substr(2));
      in_note = false;
    } else if (in_note) {
      command.notes.back() += " " + line;
    } else {
      command.notes.push_back(line);
      in_note = true;
    }
  }
}

}  // namespace

std::string OptionReference::long_name() const {
  const auto name =
      std::ranges::find_if(names, [](const std::string& one) { return one.starts_with("--"); });
  return name == names.end() ? "" : name->substr(2);
}

std::string CommandReference::joined(const std::string& separator) const {
  return join_words(words, separator);
}

std::string join_words(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

CommandReference describe_command(CLI::App& app, std::vector<std::string> parent) {
  CommandReference found;
  found.words = std::move(parent);
  found.words.push_back(app.get_name());
  found.description = app.get_description();
  add_footer(app.get_footer(), found);
  const CLI::Option* const help = app.get_help_ptr();
  for (CLI::Option* const option : app.get_options({}))
    if (option != help && !option->get_group().empty())
      found.options.push_back(describe_option(*option));
  for (CLI::App* const command : app.get_subcommands(std::function<bool(CLI::App*)>()))
    if (!command->get_group().empty())
      found.commands.push_back(describe_command(*command, found.words));
  return found;
}

}  // namespace lefort::app
