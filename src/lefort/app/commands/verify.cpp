#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/verify.h>
#include <lefort/verify/run_suite.h>

#include <memory>
#include <string>
#include <vector>

namespace lefort::app {

void add_verify_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::VerifyJob>();
  CLI::App* const command = cli.add_subcommand(
      "verify", "Verify the finite element solver against closed-form solutions");
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for verification.md and its plots; none: only the checks"),
            PathKind::kNewFolder);
  command->add_flag("--full", job->full, "Finer meshes: minutes instead of seconds");
  std::vector<std::string> names;
  for (const verify::Case& one : verify::all_cases()) names.emplace_back(one.name);
  command->add_option("--only", job->only, "Only this case")->check(CLI::IsMember(names));
  command->footer("Example:\n  lefort verify --full -o docs/studies");
  command->callback([job, &context] {
    bool passed = true;
    context.run("verify", [&](Progress& progress) -> Result<pipeline::Summary> {
      LEFORT_TRY(const pipeline::VerifySummary done, pipeline::verify_solver(*job, progress));
      passed = done.passed;
      return done.summary;
    });
    if (!passed) context.exit_code = kExitFailed;
  });
}

}  // namespace lefort::app
