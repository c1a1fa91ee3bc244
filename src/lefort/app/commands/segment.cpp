#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/segment.h>

#include <map>
#include <memory>
#include <string>

namespace lefort::app {

void add_segment_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::SegmentJob>();
  CLI::App* const command =
      cli.add_subcommand("segment", "Segment bone, mandible, teeth, soft tissue, brain and air");
  mark_path(command->add_option("ct", job->ct, "The scan: anything `lefort import` reads"),
            PathKind::kScan)
      ->required();
  mark_path(command->add_option(
                "-o,--output", job->output,
                "Folder for labels.seg.nrrd and teeth.seg.nrrd (3D Slicer), skull.vtp, skin.vtp"),
            PathKind::kNewFolder)
      ->required();
  CLI::Option* const bone_hu =
      command->add_option("--bone-hu", job->options.bone_hu, "Lower threshold of bone [HU]")
          ->check(CLI::Range(-200.0, 2000.0))
          ->capture_default_str();
  CLI::Option* const skin_hu =
      command->add_option("--skin-hu", job->options.skin_hu, "Lower threshold of the patient [HU]")
          ->check(CLI::Range(-900.0, 0.0))
          ->capture_default_str();
  command
      ->add_flag("--auto-thresholds", job->auto_thresholds,
                 "Both thresholds from the histogram (Otsu), for values that are not HU")
      ->excludes(bone_hu)
      ->excludes(skin_hu);
  command
      ->add_option("--smooth", job->finish.smoothing_passes,
                   "Passes of smoothing, which remove the steps of voxels; 0: the isosurface")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  // The number of triangles of the paper's skull (Table 1).
  static const std::map<std::string, std::string> kPresets{{"paper", "96190"}};
  command
      ->add_option("--max-triangles", job->finish.triangles,
                   "Maximum number of triangles of each surface; \"paper\": 96190")
      ->transform(CLI::Transformer(kPresets, CLI::ignore_case))
      ->check(CLI::Range(4, 100'000'000));
  command->footer(
      "Examples:\n"
      "  lefort segment ct.nrrd -o anatomy/\n"
      "  lefort segment ct.nrrd -o anatomy/ --max-triangles paper\n"
      "  lefort segment ct.nrrd -o anatomy/ --bone-hu 300");
  command->callback([job, &context] {
    context.run("segment",
                [&](Progress& progress) { return pipeline::segment_scan(*job, progress); });
  });
}

}  // namespace lefort::app
