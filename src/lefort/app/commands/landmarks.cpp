#include <lefort/app/commands/command.h>
#include <lefort/pipeline/plan.h>

#include <memory>

namespace lefort::app {

void add_landmarks_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::LandmarksJob>();
  CLI::App* const command =
      cli.add_subcommand("landmarks", "Angles and distances between landmarks, before and after");
  command->add_option("landmarks", job->before, "Landmarks, .mrk.json (3D Slicer) or .csv")
      ->required();
  command->add_option("--after", job->after, "The same landmarks after surgery");
  command->add_option("-o,--output", job->output, "The cephalometric table, .csv");
  command->add_option("--save", job->save,
                      "Write the landmarks (those of --after, if given) as .mrk.json or .csv");
  command->footer(
      "Examples:\n"
      "  lefort landmarks before.mrk.json --after after.mrk.json -o table.csv\n"
      "  lefort landmarks points.mrk.json --save points.csv\n"
      "Names and measurements: docs/guide/landmarks.md. Not for clinical use.");
  command->callback([job, &context] {
    context.run("landmarks",
                [&](Progress& progress) { return pipeline::measure_landmarks(*job, progress); });
  });
}

}  // namespace lefort::app
