#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/cephalogram.h>

#include <map>
#include <memory>
#include <string>

namespace lefort::app {
namespace {

void add_results_of_plan(CLI::App& command, pipeline::CephalogramJob& job) {
  mark_path(
      command.add_option("--check", job.check, "Folder of `lefort plan check`: bone after surgery"),
      PathKind::kFolder);
  mark_path(command.add_option("--prediction", job.prediction,
                               "Folder of `lefort predict`: skin after surgery"),
            PathKind::kFolder);
}

}  // namespace

void add_cephalogram_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::CephalogramJob>();
  const auto source_mm = std::make_shared<double>(*job->source_mm);
  const auto is_parallel = std::make_shared<bool>(false);
  CLI::App* const command = cli.add_subcommand(
      "cephalogram",
      "Lateral and frontal cephalogram of a CT, tracing, norms, as pictures and PDF");
  add_head_files(*command, job->ct, job->labels, job->landmarks);
  add_results_of_plan(*command, *job);
  const std::map<std::string, plan::Sex> sexes{{"female", plan::Sex::kFemale},
                                               {"male", plan::Sex::kMale}};
  command->add_option("--norms", job->sex, "Norms of women or men: female, male")
      ->transform(CLI::CheckedTransformer(sexes).description(""))
      ->default_str("female");
  CLI::Option* const source =
      command->add_option("--source", *source_mm, "Distance of the source [mm]")
          ->check(CLI::Range(500.0, 1e5))
          ->capture_default_str();
  command->add_flag("--parallel", *is_parallel, "Parallel rays: no magnification")
      ->excludes(source);
  mark_path(command->add_option("-o,--output", job->output, "Folder for pictures, tables and PDF"),
            PathKind::kNewFolder)
      ->required();
  command->footer(
      "Examples:\n"
      "  lefort cephalogram ct.nrrd -o cephalogram/\n"
      "  lefort cephalogram ct.nrrd --check check/ --prediction prediction/ -o cephalogram/\n"
      "Guide: docs/guide/landmarks.md. Not for clinical use.");
  command->callback([job, source_mm, is_parallel, &context] {
    job->source_mm.reset();
    if (!*is_parallel) job->source_mm = *source_mm;
    context.run("cephalogram",
                [&](Progress& progress) { return pipeline::make_cephalogram(*job, progress); });
  });
}

}  // namespace lefort::app
