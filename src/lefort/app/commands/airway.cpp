#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/airway.h>

#include <memory>

namespace lefort::app {

void add_airway_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::AirwayJob>();
  CLI::App* const command = cli.add_subcommand(
      "airway", "Measure volume and cross-sections of the pharyngeal airway in a CT");
  add_head_files(*command, job->ct, job->labels, job->landmarks);
  command
      ->add_option("--upper", job->upper,
                   "Landmark or x,y,z [mm, LPS] on the upper plane, parallel to the Frankfurt "
                   "horizontal")
      ->capture_default_str();
  command->add_option("--lower", job->lower, "The same of the lower plane")->capture_default_str();
  command
      ->add_option("--front", job->front,
                   "The same of the coronal plane in front; air anterior to it is not measured")
      ->capture_default_str();
  mark_path(command->add_option("--prediction", job->prediction,
                                "Folder of `lefort predict`: the airway also after its movement"),
            PathKind::kFolder);
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for the surface, the sections and airway.json"),
            PathKind::kNewFolder)
      ->required();
  command->footer(
      "Examples:\n"
      "  lefort airway ct.nrrd -o airway/\n"
      "  lefort airway ct.nrrd --upper 0,-35,-20 --lower 0,-30,-80 -o airway/\n"
      "Guide: docs/guide/nerve-and-airway.md. Not for clinical use.");
  command->callback([job, &context] {
    context.run("airway", [&](Progress& progress) {
      return pipeline::measure_airway_of_scan(*job, progress);
    });
  });
}

}  // namespace lefort::app
