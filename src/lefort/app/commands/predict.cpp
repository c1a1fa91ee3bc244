#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/predict.h>

#include <memory>

namespace lefort::app {

void add_predict_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::PredictJob>();
  const auto no_pictures = std::make_shared<bool>(false);
  const auto no_sensitivity = std::make_shared<bool>(false);
  CLI::App* const command =
      cli.add_subcommand("predict", "Predict the face after the planned bone movements");
  mark_path(command->add_option("plan", job->plan, "Plan file (contract/plan.schema.json)"),
            PathKind::kPlan)
      ->required();
  mark_path(command->add_option("-o,--output", job->output, "Folder for the results"),
            PathKind::kNewFolder)
      ->required();
  mark_path(command->add_option("--ct", job->ct, "The scan, instead of the one the plan names"),
            PathKind::kScan);
  command->add_option("--teeth", job->teeth,
                      "Teeth of interface and lips, instead of the plan's: auto, none, or a tooth "
                      "map (teeth.seg.nrrd)");
  command->add_flag("--no-pictures", *no_pictures, "Skip the pictures");
  command->add_flag("--no-sensitivity", *no_sensitivity,
                    "Skip the comparison of bonded and contact interfaces on a coarse mesh");
  command->footer(
      "Examples:\n"
      "  lefort predict examples/midface_forward.json --ct ct.nrrd -o forward/\n"
      "Writes report.html, prediction.json, predicted_skin.vtp and .stl, pictures/, and\n"
      "paraview/prediction.pvd. Finished stages are stored in cache/ there, and used again while\n"
      "their inputs are unchanged. Not for clinical use.");
  command->callback([job, no_pictures, no_sensitivity, &context] {
    job->pictures = !*no_pictures;
    job->sensitivity = !*no_sensitivity;
    context.run("predict",
                [&](Progress& progress) { return pipeline::predict_case(*job, progress); });
  });
}

}  // namespace lefort::app
