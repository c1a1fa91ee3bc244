#include <lefort/app/reference/bash_completion.h>

#include <fmt/format.h>

#include <functional>

namespace lefort::app {
namespace {

/// The parts that do not depend on the commands. `_lefort_paths "json csv"` completes folders and
/// files with these extensions, or any file if there is none.
constexpr const char* kFunctions =
    R"(# bash completion of lefort; written by `lefort --bash-completion`.

_lefort_paths() {
  local extension file
  local -a all
  mapfile -t all < <(compgen -f -- "$cur")
  COMPREPLY=()
  for file in "${all[@]}"; do
    if [[ -d $file ]]; then COMPREPLY+=("$file"); continue; fi
    for extension in $1; do
      if [[ $file == *."$extension" ]]; then COMPREPLY+=("$file"); break; fi
    done
  done
  if [[ -z $1 || ${#COMPREPLY[@]} -eq 0 ]]; then COMPREPLY=("${all[@]}"); fi
  compopt -o filenames 2>/dev/null
}

_lefort_folders() {
  mapfile -t COMPREPLY < <(compgen -d -- "$cur")
  compopt -o filenames 2>/dev/null
}

_lefort_words() {
  mapfile -t COMPREPLY < <(compgen -W "$1" -- "$cur")
}

)";

constexpr const char* kEnd = R"(
complete -F _lefort lefort
)";

/// "json csv" from ".json,.csv".
std::string extensions_of(std::string_view list) {
  std::string words;
  for (const char c : list) {
    if (c == ',')
      words += ' ';
    else if (c != '.' || (!words.empty() && words.back() != ' '))
      words += c;
  }
  return words;
}

/// The call that completes a value; empty if nothing can be proposed.
std::string completes(const OptionReference& option) {
  if (!option.choices.empty()) return fmt::format("_lefort_words '{}'", join_words(option.choices));
  if (option.path != nullptr && option.path->form == PathForm::kFolder) return "_lefort_folders";
  if (option.path != nullptr)
    return fmt::format("_lefort_paths '{}'", extensions_of(option.path->extensions));
  return option.value == "TEXT" ? "_lefort_paths ''" : "";
}

/// The words of a command after the name of the program.
std::string key_of(const CommandReference& command) {
  return command.joined(" ").substr(command.words.front().size());
}

void each_command(const CommandReference& command,
                  const std::function<void(const CommandReference&)>& visit) {
  visit(command);
  for (const CommandReference& nested : command.commands) each_command(nested, visit);
}

/// Lines of a `case` over "command option": values of options.
std::string value_cases(const CommandReference& command, bool is_program) {
  std::string text;
  for (const OptionReference& option : command.options) {
    if (option.is_flag() || option.names.empty()) continue;
    std::string pattern;
    for (const std::string& name : option.names)
      pattern += fmt::format("{}{}'{}:{}'", pattern.empty() ? "" : "|", is_program ? "*" : "",
                             is_program ? "" : key_of(command), name);
    const std::string call = completes(option);
    text += fmt::format("    {}) {}; return ;;\n", pattern, call.empty() ? "COMPREPLY=()" : call);
  }
  return text;
}

/// A line of a `case` over the command: nested commands, options, positional arguments.
std::string word_case(const CommandReference& command, const std::string& common) {
  std::vector<std::string> options, commands;
  std::string positional;
  for (const OptionReference& option : command.options) {
    options.insert(options.end(), option.names.begin(), option.names.end());
    if (!option.positional.empty() && positional.empty()) positional = completes(option);
  }
  for (const CommandReference& nested : command.commands) commands.push_back(nested.words.back());
  if (!commands.empty()) positional = fmt::format("_lefort_words '{}'", join_words(commands));
  if (positional.empty()) positional = "COMPREPLY=()";
  const bool is_program = command.words.size() == 1;
  return fmt::format(
      "    '{}')\n      if [[ $cur == -* ]]; then _lefort_words '{}'; else {}; fi ;;\n",
      key_of(command), join_words(options) + (is_program ? " --help" : " --help " + common),
      positional);
}

}  // namespace

std::string bash_completion(const CommandReference& program) {
  std::string commands, values, words;
  std::vector<std::string> common;
  for (const OptionReference& option : program.options)
    common.insert(common.end(), option.names.begin(), option.names.end());
  each_command(program, [&](const CommandReference& command) {
    const bool is_program = command.words.size() == 1;
    if (!is_program)
      commands += fmt::format("{}'{}'", commands.empty() ? "" : "|", key_of(command));
    if (!is_program) values += value_cases(command, false);
    words += word_case(command, join_words(common));
  });
  values += value_cases(program, true);
  std::string text = kFunctions;
  text +=
      "_lefort() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} command= word\n"
      "  COMPREPLY=()\n"
      "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
      "    case \"$command $word\" in\n";
  text += fmt::format("      {}) command+=\" $word\" ;;\n", commands);
  text += "    esac\n  done\n  case \"$command:$prev\" in\n" + values + "  esac\n";
  text += "  case \"$command\" in\n" + words + "  esac\n}\n";
  return text + kEnd;
}

}  // namespace lefort::app
