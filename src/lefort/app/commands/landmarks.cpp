#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/plan.h>

#include <memory>

namespace lefort::app {

void add_landmarks_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::LandmarksJob>();
  CLI::App* const command =
      cli.add_subcommand("landmarks", "Find landmarks; angles and distances between them");
  CLI::Option* const before =
      mark_path(command->add_option("landmarks,--landmarks", job->before,
                                    "Landmarks, .mrk.json (3D Slicer) or .csv"),
                PathKind::kLandmarks);
  CLI::Option* const find =
      mark_path(command->add_option(
                    "--find", job->find,
                    "Instead of a file: find the landmarks in this scan, anything `lefort "
                    "import` reads"),
                PathKind::kScan)
          ->excludes(before);
  mark_path(command->add_option(
                "--labels", job->labels,
                "Segmentation of that scan, .seg.nrrd; segmented automatically unless given"),
            PathKind::kLabels)
      ->needs(find);
  mark_path(command->add_option("--after", job->after, "The same landmarks after surgery"),
            PathKind::kLandmarks);
  mark_path(command->add_option("-o,--output", job->output, "The cephalometric table, .csv"),
            PathKind::kNewTable);
  mark_path(
      command->add_option("--save", job->save,
                          "Write the landmarks (those of --after, if given) as .mrk.json or .csv"),
      PathKind::kNewLandmarks);
  command->footer(
      "Examples:\n"
      "  lefort landmarks before.mrk.json --after after.mrk.json -o table.csv\n"
      "  lefort landmarks points.mrk.json --save points.csv\n"
      "  lefort landmarks --find ct.nrrd --save landmarks.mrk.json\n"
      "Names and measurements: docs/guide/landmarks.md. Not for clinical use.");
  command->callback([job, &context] {
    if (job->before.empty() && !job->find)
      throw CLI::RequiredError("landmarks: a file of landmarks, or --find");
    context.run("landmarks",
                [&](Progress& progress) { return pipeline::measure_landmarks(*job, progress); });
  });
}

}  // namespace lefort::app
