#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/server/serve_case.h>

#include <fmt/format.h>

#include <memory>

namespace lefort::app {

void add_serve_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<server::ServeJob>();
  CLI::App* const command =
      cli.add_subcommand("serve", "Plan in a browser: a local page over a case folder");
  mark_path(command->add_option("case", job->folder, "The case's folder; made if missing"),
            PathKind::kNewFolder)
      ->capture_default_str();
  command->add_option("--port", job->port, "Port to listen on; 0 takes one that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      ->add_option("--host", job->host,
                   "Address to listen on; any other than loopback "
                   "is open to the network")
      ->capture_default_str();
  command->add_flag("--open", job->open, "Open the page in the default browser");
  command->add_flag("--demo", job->demo,
                    "Start with the bundled example, unless the case has a scan");
  mark_path(command->add_option("--example", job->example, "The scan of the bundled example"),
            PathKind::kScan)
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  lefort serve my-case --open\n"
      "Prints the page's address, which contains a secret token: anyone who has it can read and\n"
      "change the case. Ctrl-C ends the server. See docs/guide/planner.md. Not for clinical use.");
  command->callback([job, &context] {
    context.run("serve", [&](Progress& progress) { return server::serve_case(*job, progress); });
  });
}

}  // namespace lefort::app
