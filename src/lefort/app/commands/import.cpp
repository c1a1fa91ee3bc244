#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/import.h>

#include <cstdlib>
#include <memory>

namespace lefort::app {

namespace {

/// An environment variable, or an empty text. Unlike arguments, it is not in the list of processes.
std::string from_environment(const char* name) {
  const char* const text = std::getenv(name);
  return text == nullptr ? "" : text;
}

}  // namespace

void add_import_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::ImportJob>();  // Lives as long as the callback.
  const auto list = std::make_shared<bool>(false);
  CLI::App* const command =
      cli.add_subcommand("import", "Read a head CT from any format into one HU volume (LPS, mm)");
  mark_path(command->add_option(
                "source", job->source,
                "DICOM folder, .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, InVesalius .inv3, or "
                "dicomweb://HOST:PORT/ROOT/studies/UID[/series/UID]"),
            PathKind::kScanSource)
      ->required();
  CLI::Option* const output = mark_path(
      command->add_option("-o,--output", job->output, "Volume to write: .nrrd, .nii.gz or .mha"),
      PathKind::kNewVolume);
  command
      ->add_option("--series", job->series,
                   "Number of the series of a DICOM folder or study, as in --list; 0: the only CT")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  command->add_flag("--list", *list, "Show the series of a DICOM folder or study, write nothing")
      ->excludes(output);
  command->footer(
      "Examples:\n"
      "  lefort import scans/patient/ --list\n"
      "  lefort import scans/patient/ --series 2 -o ct.nrrd\n"
      "  lefort import Cranium.inv3 -o ct.nrrd --json\n"
      "  lefort import dicomweb://localhost:8042/dicom-web/studies/1.2.3 -o ct.nrrd\n"
      "User and password of a server: LEFORT_DICOMWEB_USER and LEFORT_DICOMWEB_PASSWORD in the\n"
      "environment, or dicomweb://user:password@HOST. dicomwebs:// is the same encrypted.\n"
      "Patient names, dates and identifiers are not carried over.");
  command->callback([job, list, &context] {
    if (!*list && job->output.empty()) throw CLI::RequiredError("--output or --list");
    job->user = from_environment("LEFORT_DICOMWEB_USER");
    job->password = from_environment("LEFORT_DICOMWEB_PASSWORD");
    context.run("import", [&](Progress& progress) {
      return *list ? pipeline::list_scans(*job, progress) : pipeline::import_scan(*job, progress);
    });
  });
}

}  // namespace lefort::app
