#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/run.h>

#include <memory>
#include <string>

namespace lefort::app {
namespace {

constexpr const char* kFooter =
    "Examples:\n"
    "  lefort run dataset/ out/ participant\n"
    "  lefort run dataset/ out/ participant --participant-label 01 02 --n-threads 4 --mem-gb 8\n"
    "  lefort run dataset/ out/ participant --parameters sets.json --parameter-set stiff\n"
    "  lefort run dataset/ out/ group --parameters sets.json\n"
    "A BIDS App (Gorgolewski et al. 2017): docs/guide/cohorts.md. Level participant predicts each\n"
    "case with each parameter set into OUT/sub-LABEL/set-NAME/; level group writes group.json,\n"
    "group.csv and report.html. A run that was stopped resumes; several runs may share OUT. Exit\n"
    "code 1: a case failed, the others are finished. Not for clinical use.";

struct RunArguments {
  pipeline::RunJob job;
  std::string level;
  bool no_pictures = false;
  bool is_dry = false;
};

void add_options(CLI::App& command, RunArguments& arguments, CommandContext& context) {
  pipeline::RunJob& job = arguments.job;
  mark_path(
      command.add_option("input", job.input, "BIDS dataset, or a cohort as for `lefort validate`"),
      PathKind::kFolder)
      ->required();
  mark_path(command.add_option("output", job.output, "Folder for the results"),
            PathKind::kNewFolder)
      ->required();
  command.add_option("level", arguments.level, "participant: predict cases; group: statistics")
      ->required()
      ->check(CLI::IsMember({"participant", "group"}));
  command.add_option("--participant-label,--participant_label", job.participants,
                     "Labels of cases, with or without sub-; default: all");
  mark_path(
      command.add_option("--parameters", job.parameters,
                         "Parameter sets, .json or .csv (contract/parameter_sets.schema.json); "
                         "default: the set `default`, the plans as they are"),
      PathKind::kParameters);
  command.add_option("--parameter-set", job.sets, "Names of sets of the file; default: all");
  command
      .add_option("--n-threads,--n_threads,--nthreads,--n_cpus", context.threads,
                  "Threads; 0: all of the machine")
      ->check(CLI::Range(0, 1024));
  command
      .add_option("--mem-gb,--mem_gb", job.memory_gb,
                  "Limit of the memory of this process [GB]; a case that needs more fails")
      ->check(CLI::Range(0.01, 1e5));
  mark_path(
      command.add_option("-w,--work-dir,--work_dir", job.work,
                         "Folder for the cache and unfinished steps, shared by all processes of a "
                         "run; default: OUT/.lefort"),
      PathKind::kNewFolder);
  command.add_flag("--skip-bids-validation,--skip_bids_validator", job.skip_bids_validation,
                   "Accept a dataset without dataset_description.json");
  command.add_flag("--achieved", job.achieved_movements,
                   "Predict the movements found in the bone after surgery, not those of the plans");
  command.add_option("--voxel", job.voxel_mm, "Edge of a voxel of cases known as surfaces [mm]")
      ->check(CLI::Range(0.3, 5.0))
      ->capture_default_str();
  command.add_flag("--no-pictures", arguments.no_pictures, "Skip the pictures");
  command.add_flag("--steps", job.paraview, "Also write the tissue at each step (paraview/)");
  command.add_flag("--dry-run", arguments.is_dry,
                   "List the evaluations and their states; compute nothing");
}

}  // namespace

void add_run_command(CLI::App& cli, CommandContext& context) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* const command =
      cli.add_subcommand("run", "Predict all cases of a cohort with all parameter sets");
  add_options(*command, *arguments, context);
  command->footer(kFooter);
  command->callback([arguments, &context] {
    pipeline::RunJob& job = arguments->job;
    job.pictures = !arguments->no_pictures;
    if (const auto label = pipeline::repeated_label(job.participants))
      throw CLI::ValidationError("--participant-label", "the label " + *label + " occurs twice");
    context.run("run", [&](Progress& progress) {
      if (arguments->is_dry) return pipeline::list_evaluations(job);
      return arguments->level == "group" ? pipeline::run_group(job, progress)
                                         : pipeline::run_participants(job, progress);
    });
  });
}

}  // namespace lefort::app
