#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/validate.h>

#include <memory>

namespace lefort::app {

void add_validate_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::ValidateJob>();
  const auto no_pictures = std::make_shared<bool>(false);
  CLI::App* const command = cli.add_subcommand(
      "validate", "Compare predicted faces with achieved faces over a cohort of cases");
  mark_path(command->add_option(
                "cohort", job->cohort,
                "Folder of case folders, each with a head before and after surgery and a plan"),
            PathKind::kFolder)
      ->required();
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for the report, not inside the cohort"),
            PathKind::kNewFolder)
      ->required();
  command->add_flag(
      "--achieved", job->achieved_movements,
      "Predict the movements found in the bone after surgery, not those of the plans");
  command
      ->add_option("--element-size", job->element_size_mm,
                   "Edge of tetrahedra near the segments, instead of the plans' [mm]")
      ->check(CLI::Range(0.5, 20.0));
  command->add_option("--voxel", job->voxel_mm, "Edge of a voxel of cases known as surfaces [mm]")
      ->check(CLI::Range(0.3, 5.0))
      ->capture_default_str();
  command->add_flag("--no-pictures", *no_pictures, "Skip the pictures");
  command->footer(
      "Examples:\n"
      "  lefort validate cohort/ -o report/\n"
      "  lefort validate cohort/ -o report/ --achieved --element-size 4\n"
      "Writes validation.json, validation.csv, report.html and pictures/: docs/guide/validate.md.\n"
      "A run that was stopped resumes. Not for clinical use.");
  command->callback([job, no_pictures, &context] {
    job->pictures = !*no_pictures;
    context.run("validate",
                [&](Progress& progress) { return pipeline::validate_cohort(*job, progress); });
  });
}

}  // namespace lefort::app
