#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/import.h>
#include <lefort/pipeline/validate.h>

#include <map>
#include <memory>

namespace lefort::app {
namespace {

void add_cohort_options(CLI::App& command, pipeline::PhantomCohortJob& cohort) {
  CLI::Option* const cases =
      command
          .add_option(
              "--cohort", cohort.cases,
              "Instead of one head: a cohort of this many cases for validate and calibrate, "
              "with faces after surgery made by predictions; truth.json has their "
              "parameters")
          ->check(CLI::Range(1, 99));
  command.add_option("--seed", cohort.seed, "Of a cohort: heads, movements and parameters")
      ->needs(cases)
      ->capture_default_str();
  command
      .add_option("--skin-noise", cohort.skin_noise_mm,
                  "Of a cohort: standard deviation of the measured skin [mm]")
      ->check(CLI::Range(0.0, 5.0))
      ->needs(cases)
      ->capture_default_str();
  command.add_option("--element-size", cohort.element_size_mm, "Of a cohort: of its plans [mm]")
      ->check(CLI::Range(2.0, 20.0))
      ->needs(cases)
      ->capture_default_str();
}

void add_head_option(CLI::App& command, pipeline::PhantomJob& job) {
  const std::map<std::string, pipeline::PhantomHead> heads{
      {"simple", pipeline::PhantomHead::kSimple},
      {"teeth", pipeline::PhantomHead::kTeeth},
      {"open-bite", pipeline::PhantomHead::kOpenBite},
      {"dentition", pipeline::PhantomHead::kDentition}};
  command
      .add_option(
          "--head", job.head,
          "Simple shapes; with orbits, nose, teeth, lips and known landmarks; the same with an "
          "open bite of 4 degrees; or with 28 single teeth, canals and intraoral scans")
      ->transform(CLI::CheckedTransformer(heads).description("{simple,teeth,open-bite,dentition}"))
      ->type_name("TEXT")
      ->default_str("simple");
}

void add_dentition_options(CLI::App& command, pipeline::PhantomJob& job) {
  command
      .add_option("--shape", job.shape,
                  "Of a dentition: number of a random head and its teeth; 0: the mean head")
      ->capture_default_str();
  command
      .add_option("--retrusion", job.retrusion_mm,
                  "Of a dentition: the mandible with its teeth is so far behind occlusion; "
                  "negative: in front of it [mm]")
      ->check(CLI::Range(-8.0, 8.0))
      ->capture_default_str();
  command
      .add_option("--deviation", job.deviation_mm,
                  "Of a dentition: the mandible with its teeth is so far to the left [mm]")
      ->check(CLI::Range(-6.0, 6.0))
      ->capture_default_str();
}

}  // namespace

void add_phantom_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::PhantomJob>();
  const auto cohort = std::make_shared<pipeline::PhantomCohortJob>();
  cohort->cases = 0;
  CLI::App* const command = cli.add_subcommand(
      "phantom", "Write DICOM files of a synthetic head, to try lefort without a patient");
  mark_path(command->add_option(
                "-o,--output", job->output,
                "Folder for dicom/ and labels.seg.nrrd, the true labels; or for the cohort"),
            PathKind::kNewFolder)
      ->required();
  const std::map<std::string, pipeline::PhantomVariant> variants{
      {"plain", pipeline::PhantomVariant::kPlain},
      {"tilted", pipeline::PhantomVariant::kTilted},
      {"shuffled", pipeline::PhantomVariant::kShuffled},
      {"oblique", pipeline::PhantomVariant::kOblique},
      {"feet-first", pipeline::PhantomVariant::kFeetFirst}};
  command->add_option("--variant", job->variant, "How it is scanned")
      ->transform(CLI::CheckedTransformer(variants).description(
          "{plain,tilted,shuffled,oblique,feet-first}"))
      ->type_name("TEXT")
      ->default_str("plain");
  add_head_option(*command, *job);
  CLI::Option* const voxel = command
                                 ->add_option("--voxel", job->voxel_mm,
                                              "Edge of a voxel [mm]; default: 1.4, of a cohort "
                                              "2, of a dentition 0.6")
                                 ->check(CLI::Range(0.3, 5.0));
  command->add_option("--noise", job->noise_hu, "Standard deviation of the noise [HU]")
      ->check(CLI::Range(0.0, 200.0))
      ->capture_default_str();
  add_dentition_options(*command, *job);
  add_cohort_options(*command, *cohort);
  command->footer(
      "Examples:\n"
      "  lefort phantom -o head/\n"
      "  lefort phantom --head teeth -o head/\n"
      "  lefort phantom --head dentition --retrusion -4 --deviation 2 -o head/\n"
      "  lefort import head/dicom -o ct.nrrd\n"
      "  lefort segment ct.nrrd -o anatomy/\n"
      "  lefort phantom --cohort 10 -o cohort/");
  command->callback([job, cohort, voxel, &context] {
    cohort->output = job->output;
    cohort->noise_hu = job->noise_hu;
    if (voxel->count() > 0) cohort->voxel_mm = job->voxel_mm;
    constexpr double kDentitionVoxel_mm = 0.6;
    if (voxel->count() == 0 && job->head == pipeline::PhantomHead::kDentition)
      job->voxel_mm = kDentitionVoxel_mm;
    context.run("phantom", [&](Progress& progress) {
      return cohort->cases > 0 ? pipeline::make_phantom_cohort(*cohort, progress)
                               : pipeline::make_phantom(*job, progress);
    });
  });
}

}  // namespace lefort::app
