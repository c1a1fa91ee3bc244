#include <lefort/app/reference/bash_completion.h>
#include <lefort/app/reference/command_reference.h>
#include <lefort/app/reference/man_page.h>
#include <lefort/app/reference/reference_options.h>
#include <lefort/app/reference/slicer_module.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace lefort::app {
namespace {

/// The command on the command line; the program if there is none.
CommandReference parsed_command(CLI::App& cli) {
  CLI::App* app = &cli;
  std::vector<std::string> parent;
  while (!app->get_subcommands().empty()) {
    parent.push_back(app->get_name());
    app = app->get_subcommands().front();
  }
  return describe_command(*app, parent);
}

Result<void> write_pages(const std::filesystem::path& folder, const CommandReference& command,
                         const CommandReference& program) {
  const std::filesystem::path page = folder / (command.joined("-") + ".1");
  LEFORT_TRY_VOID(io::write_text(page, man_page(command, program)));
  for (const CommandReference& nested : command.commands)
    LEFORT_TRY_VOID(write_pages(folder, nested, program));
  return {};
}

Result<void> write_wrappers(const std::filesystem::path& folder) {
  using std::filesystem::perms;
  for (const SlicerModule& module : slicer_modules()) {
    std::string name = "lefort-slicer";
    for (const std::string& word : module.words) name += "-" + word;
    LEFORT_TRY_VOID(io::write_text(folder / name, slicer_wrapper(module)));
    std::error_code error;
    std::filesystem::permissions(folder / name,
                                 perms::owner_exec | perms::group_exec | perms::others_exec,
                                 std::filesystem::perm_options::add, error);
    if (error)
      return fail(ErrorCode::kFileUnwritable,
                  fmt::format("{} cannot be made executable: {}", (folder / name).string(),
                              error.message()));
  }
  return {};
}

/// Writes man1/, completions/lefort and slicer/ into `folder`.
Result<void> write_reference(const std::filesystem::path& folder, const CommandReference& program) {
  for (const char* part : {"man1", "completions", "slicer"}) {
    std::error_code error;
    std::filesystem::create_directories(folder / part, error);
    if (error)
      return fail(ErrorCode::kFileUnwritable,
                  fmt::format("the folder {} cannot be made: {}", (folder / part).string(),
                              error.message()));
  }
  LEFORT_TRY_VOID(write_pages(folder / "man1", program, program));
  LEFORT_TRY_VOID(io::write_text(folder / "completions" / "lefort", bash_completion(program)));
  return write_wrappers(folder / "slicer");
}

/// Ends the parsing and the program, with exit code 0.
[[noreturn]] void done() { throw CLI::Success(); }

}  // namespace

void add_reference_options(CLI::App& cli) {
  constexpr const char* kGroup = "Description of the command line";
  cli.add_flag_callback(
         "--man",
         [&cli] {
           fmt::print("{}", man_page(parsed_command(cli), describe_command(cli)));
           done();
         },
         "Print the manual page of the command")
      ->group(kGroup);
  cli.add_flag_callback(
         "--xml",
         [&cli] {
           const auto xml = slicer_description(parsed_command(cli), describe_command(cli));
           if (!xml) throw CLI::ValidationError("--xml", xml.error().message);
           fmt::print("{}", *xml);
           done();
         },
         "Print the description of the command for 3D Slicer")
      ->group(kGroup);
  cli.add_flag_callback(
         "--bash-completion",
         [&cli] {
           fmt::print("{}", bash_completion(describe_command(cli)));
           done();
         },
         "Print a script that completes command lines in bash")
      ->group(kGroup);
  const auto write = [&cli](const std::string& folder) {
    const auto written = write_reference(folder, describe_command(cli));
    if (!written) throw std::runtime_error(written.error().message);
    done();
  };
  mark_path(cli.add_option_function<std::string>(
                "--write-reference", write,
                "Write manual pages, completion and modules for 3D Slicer into a folder"),
            PathKind::kNewFolder)
      ->group(kGroup);
}

}  // namespace lefort::app
