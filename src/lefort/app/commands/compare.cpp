#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/compare.h>

#include <memory>

namespace lefort::app {

void add_compare_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::CompareJob>();
  const auto no_pictures = std::make_shared<bool>(false);
  CLI::App* const command = cli.add_subcommand(
      "compare", "Measure the distance between two faces, and the achieved bone movements");
  mark_path(command->add_option("face", job->face,
                                "A face: .vtp, .stl, .ply, .obj, or the folder of a prediction"),
            PathKind::kFace)
      ->required();
  CLI::Option* const other =
      mark_path(command->add_option("other,--other", job->other,
                                    "The face to compare with, in the same formats"),
                PathKind::kFace);
  mark_path(
      command->add_option("--after-ct", job->after_ct,
                          "Instead of another face, a scan after surgery, in any position: it is "
                          "registered on the stationary bone, and the movement of each segment is "
                          "measured"),
      PathKind::kScan)
      ->excludes(other);
  mark_path(command->add_option("-o,--output", job->output, "Folder for the results"),
            PathKind::kNewFolder)
      ->required();
  mark_path(command->add_option(
                "--before", job->before,
                "The face before surgery, as the baseline without change (default for the "
                "folder of a prediction: the face before surgery in it)"),
            PathKind::kSurface);
  mark_path(command->add_option(
                "--landmarks", job->landmarks,
                "Landmarks before surgery, .mrk.json or .csv: those of the skin define nose, "
                "lips, chin and cheeks (default for the folder of a prediction: those of its "
                "plan)"),
            PathKind::kLandmarks);
  command->add_flag("--no-pictures", *no_pictures, "Skip the pictures");
  command->footer(
      "Examples:\n"
      "  lefort compare forward/ forward_down/ -o between_plans/\n"
      "  lefort compare forward/ --after-ct after.nrrd -o error/\n"
      "  lefort compare predicted.stl scanned.ply --before before.stl -o error/\n"
      "Writes compare.json, regions.csv, difference.vtp and pictures/: docs/guide/compare.md.\n"
      "Not for clinical use.");
  command->callback([job, no_pictures, &context] {
    job->pictures = !*no_pictures;
    context.run("compare",
                [&](Progress& progress) { return pipeline::compare_faces(*job, progress); });
  });
}

}  // namespace lefort::app
