#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/nerve.h>

#include <memory>

namespace lefort::app {

void add_nerve_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::NerveJob>();
  CLI::App* const command =
      cli.add_subcommand("nerve", "Find the canals of the inferior alveolar nerves in a CT");
  add_head_files(
      *command, job->ct, job->labels, job->landmarks,
      "Landmarks; corrected foramina and points on a canal (MdF-R, IAN-R-1, MeF-R, ...)");
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for the canals, nerve.mrk.json and nerve.json"),
            PathKind::kNewFolder)
      ->required();
  command->footer(
      "Examples:\n"
      "  lefort nerve ct.nrrd -o nerve/\n"
      "  lefort nerve ct.nrrd --landmarks corrected.mrk.json -o nerve/\n"
      "Guide: docs/guide/nerve-and-airway.md. Not for clinical use.");
  command->callback([job, &context] {
    context.run("nerve",
                [&](Progress& progress) { return pipeline::trace_nerves(*job, progress); });
  });
}

}  // namespace lefort::app
