#include <lefort/app/reference/slicer_module.h>
#include <lefort/core/escape_markup.h>
#include <lefort/core/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace lefort::app {
namespace {

/// A name that begins with a letter and has letters, digits and underscores.
std::string identifier(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return text;
}

/// "Element size" from "element-size", "Bone HU" from "bone-hu".
std::string label_of(std::string text) {
  if (text == "ct") return "CT";
  if (text.ends_with("-hu") || text.ends_with("-ct"))
    std::transform(text.end() - 2, text.end(), text.end() - 2,
                   [](unsigned char c) { return std::toupper(c); });
  std::ranges::replace(text, '-', ' ');
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

bool is_number(const OptionReference& option) {
  return option.value == "FLOAT" || option.value == "INT" || option.value == "UINT";
}

/// The element of the Slicer Execution Model for an option.
std::string element_of(const OptionReference& option) {
  if (option.is_flag()) return "boolean";
  if (option.path != nullptr) {
    if (option.path->form == PathForm::kVolume) return "image";
    return option.path->form == PathForm::kFolder ? "directory" : "file";
  }
  if (option.is_many) {
    if (!is_number(option)) return "string-vector";
    return option.value == "FLOAT" ? "double-vector" : "integer-vector";
  }
  const bool may_be_given_always =
      !option.has_relation && (option.is_required || !option.default_text.empty());
  if (!may_be_given_always) return "string";
  if (!option.choices.empty())
    return is_number(option) ? "integer-enumeration" : "string-enumeration";
  if (!is_number(option)) return "string";
  return option.value == "FLOAT" ? "double" : "integer";
}

std::string default_of(const OptionReference& option, const std::string& element) {
  if (element == "boolean") return "false";
  if (option.has_relation) return "";
  if (!option.default_text.empty()) return option.default_text;
  return option.choices.empty() ? "" : option.choices.front();
}

/// The description, with what the element cannot express.
std::string help_of(const OptionReference& option, const std::string& element) {
  std::string text = option.description;
  if (element == "string" && !option.choices.empty())
    text += "; one of: " + join_words(option.choices);
  if (element == "string" && option.has_relation && !option.default_text.empty())
    text += "; default: " + option.default_text;
  if (option.is_required) text += " (required)";
  return text;
}

/// \param index  position among the positional arguments.
std::string parameter(const OptionReference& option, int index) {
  const std::string element = element_of(option);
  const std::string long_name = option.long_name();
  const std::string name = long_name.empty() ? option.positional : long_name;
  std::string attributes;
  if (element == "image") attributes = " type=\"scalar\" fileExtensions=\".nrrd\"";
  if (element == "file")
    attributes = fmt::format(" fileExtensions=\"{}\"", option.path->extensions);
  std::string text =
      fmt::format("    <{}{}>\n      <name>{}</name>\n", element, attributes, identifier(name));
  text += long_name.empty() ? fmt::format("      <index>{}</index>\n", index)
                            : fmt::format("      <longflag>{}</longflag>\n", long_name);
  text += fmt::format("      <description>{}</description>\n      <label>{}</label>\n",
                      escape_markup(help_of(option, element)), label_of(name));
  const std::string value = default_of(option, element);
  if (!value.empty()) text += fmt::format("      <default>{}</default>\n", escape_markup(value));
  if (option.path != nullptr)
    text +=
        fmt::format("      <channel>{}</channel>\n", option.path->is_output ? "output" : "input");
  if (element.ends_with("enumeration"))
    for (const std::string& choice : option.choices)
      text += fmt::format("      <element>{}</element>\n", escape_markup(choice));
  if (option.range && (element == "double" || element == "integer"))
    text += fmt::format(
        "      <constraints>\n        <minimum>{}</minimum>\n        <maximum>{}</maximum>\n"
        "        <step>{}</step>\n      </constraints>\n",
        option.range->first, option.range->second,
        element == "integer" || option.range->second > 50.0 ? "1" : "0.1");
  return text + fmt::format("    </{}>\n", element);
}

std::string group(const std::string& label, const std::string& description,
                  const std::string& parameters, bool is_advanced) {
  if (parameters.empty()) return {};
  return fmt::format(
      "  <parameters{}>\n    <label>{}</label>\n    <description>{}</description>\n{}"
      "  </parameters>\n",
      is_advanced ? " advanced=\"true\"" : "", label, description, parameters);
}

}  // namespace

const std::vector<SlicerModule>& slicer_modules() {
  static const std::vector<SlicerModule> modules{
      {{"import"}, "Import head CT"},    {{"segment"}, "Segment head"},
      {{"landmarks"}, "Find landmarks"}, {{"field", "build"}, "Distance field of a bone"},
      {{"plan", "check"}, "Check plan"}, {{"predict"}, "Predict face"},
      {{"compare"}, "Compare faces"},    {{"solve"}, "Solve deck"}};
  return modules;
}

Result<std::string> slicer_description(const CommandReference& command,
                                       const CommandReference& program) {
  const std::vector<std::string> words(command.words.begin() + 1, command.words.end());
  const auto module = std::ranges::find(slicer_modules(), words, &SlicerModule::words);
  if (module == slicer_modules().end()) {
    std::string names;
    for (const SlicerModule& one : slicer_modules())
      names += (names.empty() ? "" : ", ") + join_words(one.words);
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} is not a module of 3D Slicer; modules are {}", command.joined(" "), names));
  }
  std::string inputs, outputs, settings, common;
  int index = 0;
  for (const OptionReference& option : command.options) {
    const std::string text = parameter(option, index);
    if (option.long_name().empty()) ++index;
    const bool is_path = option.path != nullptr;
    (is_path ? option.path->is_output ? outputs : inputs : settings) += text;
  }
  for (const OptionReference& option : program.options)
    if (option.long_name() == "threads") common += parameter(option, 0);

  std::string help = command.description + ".";
  for (const std::string& note : command.notes) help += " " + note;
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n";
  text += "  <category>Cranio-Maxillofacial Surgery</category>\n";
  text += fmt::format("  <title>{}</title>\n", module->title);
  text += fmt::format("  <description>{}</description>\n",
                      escape_markup(help + " " + kNotForClinicalUse));
  text += fmt::format("  <version>{}</version>\n", kVersion);
  text += fmt::format(
      "  <documentation-url>file:///usr/share/doc/lefort/guide/slicer.md</documentation-url>\n");
  text += "  <license>GPL-3.0-or-later</license>\n";
  text += "  <contributor>The lefort contributors</contributor>\n";
  text += group("Inputs", "What is read", inputs, false);
  text += group("Outputs", "What is written", outputs, false);
  text += group("Settings", "Options of the command", settings, false);
  text += group("Computation", "Options of all commands", common, true);
  return text + "</executable>\n";
}

std::string slicer_wrapper(const SlicerModule& module) {
  return fmt::format(
      "#!/bin/sh\n"
      "# lefort {0} as a module of 3D Slicer, whose own libraries must not get into lefort.\n"
      "unset LD_LIBRARY_PATH LD_PRELOAD\n"
      "lefort=$(dirname \"$0\")/../../../bin/lefort\n"
      "[ -x \"$lefort\" ] || lefort=lefort\n"
      "exec \"$lefort\" --slicer-progress {0} \"$@\"\n",
      join_words(module.words));
}

}  // namespace lefort::app
