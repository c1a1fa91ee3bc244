#include <lefort/app/reference/man_page.h>
#include <lefort/core/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <span>
#include <string_view>

namespace lefort::app {
namespace {

/// A character for troff, as one types it in a program: a hyphen is a minus sign.
std::string code_character(char c) {
  switch (c) {
    case '\\':
      return "\\e";
    case '-':
      return "\\-";
    case '\'':
      return "\\(aq";
    case '^':
      return "\\(ha";
    case '~':
      return "\\(ti";
    default:
      return std::string(1, c);
  }
}

/// A line that begins with a period or quote would be a request.
std::string protect_begin(const std::string& text) {
  const bool is_request = !text.empty() && (text.front() == '.' || text.front() == '\'');
  return is_request ? "\\&" + text : text;
}

/// Text of a program.
std::string code(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += code_character(c);
  return protect_begin(escaped);
}

/// Prose: options keep their hyphens, `quoted` commands are bold.
std::string prose(std::string_view text) {
  std::string escaped;
  bool in_code = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char before = at == 0 ? ' ' : text[at - 1];
    if (text[at] == '`') {
      in_code = !in_code;
      escaped += in_code ? "\\fB" : "\\fR";
    } else if (text[at] == '-' && (in_code || before == ' ' || before == '(' || before == '-')) {
      escaped += "\\-";
    } else {
      escaped += text[at] == '-' ? "-" : code_character(text[at]);
    }
  }
  return protect_begin(escaped);
}

std::string sentence(std::string text) {
  const auto last = text.find_last_not_of(" \n");
  text.resize(last == std::string::npos ? 0 : last + 1);
  if (!text.empty() && text.back() != '.') text += '.';
  return text;
}

/// "-o, --output FOLDER" with fonts.
std::string heading(const OptionReference& option) {
  std::string text;
  for (const std::string& name : option.names)
    text += (text.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", code(name));
  if (option.names.empty()) return fmt::format("\\fI{}\\fR", code(option.positional));
  if (!option.is_flag()) text += fmt::format(" \\fI{}\\fR", code(option.value));
  if (option.is_many) text += " ...";
  return text;
}

std::string list_of(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values)
    text += (text.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", code(value));
  return text;
}

std::string description_of(const OptionReference& option) {
  std::string text = prose(sentence(option.description));
  if (!option.choices.empty()) text += fmt::format(" One of {}.", list_of(option.choices));
  if (option.range)
    text += fmt::format(" From {} to {}.", code(fmt::format("{}", option.range->first)),
                        code(fmt::format("{}", option.range->second)));
  if (option.is_required && !option.names.empty()) text += " Required.";
  if (!option.is_required && option.names.empty()) text += " Optional.";
  if (!option.default_text.empty())
    text += fmt::format(" Default: \\fB{}\\fR.", code(option.default_text));
  return text;
}

std::string synopsis(const CommandReference& command) {
  std::string text = fmt::format(".B {}\n", code(command.joined(" ")));
  if (!command.commands.empty()) return text + "\\fICOMMAND\\fR [\\fIoptions\\fR]\n";
  text += "[\\fIoptions\\fR]";
  for (const OptionReference& option : command.options) {
    const std::string shown =
        option.positional.empty()
            ? fmt::format("\\fB{}\\fR \\fI{}\\fR", code(option.names.front()), code(option.value))
            : fmt::format("\\fI{}\\fR", code(option.positional));
    const bool is_listed = option.is_required || !option.positional.empty();
    if (!is_listed) continue;
    const std::string dots = option.is_many && !option.positional.empty() ? " ..." : "";
    text += option.is_required ? " " + shown + dots : fmt::format(" [{}{}]", shown, dots);
  }
  return text + "\n";
}

template <class Filter>
std::string options_section(const std::string& title, const CommandReference& command,
                            Filter&& filter) {
  std::string text;
  for (const OptionReference& option : command.options)
    if (filter(option))
      text += fmt::format(".TP\n{}\n{}\n", heading(option), description_of(option));
  return text.empty() ? text : fmt::format(".SH {}\n{}", title, text);
}

std::string commands_section(const CommandReference& command) {
  std::string text;
  for (const CommandReference& nested : command.commands)
    text += fmt::format(".TP\n.BR {} (1)\n{}\n", code(nested.joined("-")),
                        prose(sentence(nested.description)));
  return text.empty() ? text : ".SH COMMANDS\n" + text;
}

std::string examples_section(const CommandReference& command) {
  if (command.examples.empty()) return {};
  std::string text = ".SH EXAMPLES\n";
  for (const std::string& example : command.examples) {
    text += ".PP\n.nf\n.RS\n";
    std::size_t begin = 0;
    while (begin <= example.size()) {
      const std::size_t end = std::min(example.find('\n', begin), example.size());
      text += code(std::string_view(example).substr(begin, end - begin)) + "\n";
      begin = end + 1;
    }
    text += ".RE\n.fi\n";
  }
  return text;
}

/// The pages of the program, of the command around this one, and of the commands beside it.
std::string see_also(const CommandReference& command, const CommandReference& program) {
  std::vector<std::string> pages;
  const CommandReference* around = &program;
  while (around->words.size() + 1 < command.words.size()) {
    pages.push_back(around->joined("-"));
    const auto next = std::ranges::find_if(around->commands, [&](const CommandReference& one) {
      return std::ranges::equal(one.words, std::span(command.words).first(one.words.size()));
    });
    around = &*next;
  }
  if (command.words.size() > 1) pages.push_back(around->joined("-"));
  const std::string own = command.joined("-");
  for (const CommandReference& beside : around->commands)
    if (beside.joined("-") != own) pages.push_back(beside.joined("-"));
  std::string text = ".SH SEE ALSO\n";
  for (std::size_t index = 0; index < pages.size(); ++index)
    text += fmt::format(".BR {} (1){}\n", code(pages[index]), index + 1 < pages.size() ? "," : "");
  return text;
}

}  // namespace

std::string man_page(const CommandReference& command, const CommandReference& program) {
  const bool is_program = command.words.size() == 1;
  std::string summary = command.description.substr(0, command.description.find('\n'));
  if (const std::size_t colon = summary.find(": "); is_program && colon != std::string::npos)
    summary = summary.substr(colon + 2);
  if (summary.size() > 1 && std::islower(static_cast<unsigned char>(summary[1])) != 0)
    summary[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(summary[0])));
  if (!summary.empty() && summary.back() == '.') summary.pop_back();

  std::string title = command.joined("-");
  std::ranges::transform(title, title.begin(), [](unsigned char c) { return std::toupper(c); });
  std::string text =
      fmt::format(".TH {} 1 \"\" \"lefort {}\" \"User Commands\"\n", code(title), kVersion);
  text += ".nh\n.ad l\n";
  text += fmt::format(".SH NAME\n{} \\- {}\n", code(command.joined("-")), prose(summary));
  text += ".SH SYNOPSIS\n" + synopsis(command);
  text +=
      fmt::format(".SH DESCRIPTION\n{}\n",
                  prose(sentence(is_program ? "Planning of cranio-maxillofacial surgery " + summary
                                            : command.description)));
  for (const std::string& note : command.notes) text += ".PP\n" + prose(sentence(note)) + "\n";
  text += commands_section(command);
  const auto is_argument = [](const OptionReference& one) { return one.names.empty(); };
  const auto is_option = [](const OptionReference& one) { return !one.names.empty(); };
  const auto is_common = [](const OptionReference& one) {
    return one.group == "Options" && one.long_name() != "version";
  };
  text += options_section("ARGUMENTS", command, is_argument);
  text += options_section("OPTIONS", command, is_option);
  if (!is_program) text += options_section("OPTIONS OF ALL COMMANDS", program, is_common);
  text += examples_section(command);
  text +=
      ".SH EXIT STATUS\n"
      ".TP\n.B 0\nDone.\n"
      ".TP\n.B 1\nFailed; one line on standard error states why. Also: done, but with findings\n"
      "(\\fBplan check\\fR) or failed checks (\\fBverify\\fR).\n"
      ".TP\n.B 2\nWrong usage.\n";
  text += fmt::format(".SH NOTES\n{}\n", prose(kNotForClinicalUse));
  return text + see_also(command, program);
}

}  // namespace lefort::app
