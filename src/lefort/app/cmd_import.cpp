#include <lefort/app/command.h>

#include <memory>

namespace lefort::app {

void add_import_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<ImportJob>();  // Lives as long as the callback.
  CLI::App* const command =
      cli.add_subcommand("import", "Read a head CT from any format into one HU volume (LPS, mm)");
  command
      ->add_option("source", job->source,
                   "DICOM folder, .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd or InVesalius .inv3")
      ->required();
  command->add_option("-o,--output", job->output, "Volume to write: .nrrd, .nii.gz or .mha")
      ->required();
  command
      ->add_option("--series", job->series,
                   "Which series of a DICOM folder, as the error message counts them")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  lefort import scans/patient/ -o ct.nrrd\n"
      "  lefort import Cranium.inv3 -o ct.nrrd --json\n"
      "Patient names, dates and identifiers are not carried over.");
  command->callback([job, &context] {
    context.run("import", [&](Progress& progress) { return import_scan(*job, progress); });
  });
}

}  // namespace lefort::app
