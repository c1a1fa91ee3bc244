#include <lefort/app/commands/command.h>
#include <lefort/pipeline/import.h>

#include <map>
#include <memory>

namespace lefort::app {

void add_phantom_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::PhantomJob>();
  CLI::App* const command = cli.add_subcommand(
      "phantom", "Write DICOM files of a synthetic head, to try lefort without a patient");
  command
      ->add_option("-o,--output", job->output,
                   "Folder for dicom/ and labels.seg.nrrd, the true labels")
      ->required();
  const std::map<std::string, pipeline::PhantomVariant> variants{
      {"plain", pipeline::PhantomVariant::kPlain},
      {"tilted", pipeline::PhantomVariant::kTilted},
      {"shuffled", pipeline::PhantomVariant::kShuffled},
      {"oblique", pipeline::PhantomVariant::kOblique},
      {"feet-first", pipeline::PhantomVariant::kFeetFirst}};
  command->add_option("--variant", job->variant, "How it is scanned (plain)")
      ->transform(CLI::CheckedTransformer(variants).description(
          "{plain,tilted,shuffled,oblique,feet-first}"));
  command->add_option("--voxel", job->voxel_mm, "Edge of a voxel [mm]")
      ->check(CLI::Range(0.3, 5.0))
      ->capture_default_str();
  command->add_option("--noise", job->noise_hu, "Standard deviation of the noise [HU]")
      ->check(CLI::Range(0.0, 200.0))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  lefort phantom -o head/\n"
      "  lefort import head/dicom -o ct.nrrd\n"
      "  lefort segment ct.nrrd -o anatomy/");
  command->callback([job, &context] {
    context.run("phantom",
                [&](Progress& progress) { return pipeline::make_phantom(*job, progress); });
  });
}

}  // namespace lefort::app
