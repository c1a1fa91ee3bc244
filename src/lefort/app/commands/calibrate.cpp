#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/validate.h>

#include <memory>

namespace lefort::app {

void add_calibrate_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::CalibrateJob>();
  CLI::App* const command = cli.add_subcommand(
      "calibrate", "Fit parameters of the prediction to a cohort, with cross-validation");
  mark_path(command->add_option("cohort", job->cohort, "Folder of case folders, as for validate"),
            PathKind::kFolder)
      ->required();
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for the report, not inside the cohort"),
            PathKind::kNewFolder)
      ->required();
  command
      ->add_option(
          "--parameters", job->parameters,
          "Parameters to fit: skin_ratio, poisson, elevation_margin_mm, interface_layer_mm "
          "(default: the first two)")
      ->delimiter(',');
  command->add_flag(
      "--achieved", job->achieved_movements,
      "Predict the movements found in the bone after surgery, not those of the plans");
  command
      ->add_option(
          "--element-size", job->element_size_mm,
          "Edge of tetrahedra near the segments [mm] (4, or that of a plan if it is larger)")
      ->check(CLI::Range(0.5, 20.0));
  command->add_option("--voxel", job->voxel_mm, "Edge of a voxel of cases known as surfaces [mm]")
      ->check(CLI::Range(0.3, 5.0))
      ->capture_default_str();
  command
      ->add_option("--max-iterations", job->max_iterations,
                   "Maximum number of iterations of each fit")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  lefort calibrate cohort/ -o report/\n"
      "  lefort calibrate cohort/ -o report/ --parameters skin_ratio,elevation_margin_mm\n"
      "Writes calibration.json, calibration.csv and calibration.html: docs/guide/validate.md.\n"
      "A run that was stopped resumes. Not for clinical use.");
  command->callback([job, &context] {
    context.run("calibrate",
                [&](Progress& progress) { return pipeline::calibrate_cohort(*job, progress); });
  });
}

}  // namespace lefort::app
