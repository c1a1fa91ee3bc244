#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/optimize.h>
#include <lefort/pipeline/plan.h>

#include <memory>

namespace lefort::app {
namespace {

void add_limits(CLI::App& command, decltype(pipeline::CheckPlanJob::limits)& limits) {
  command.add_option("--overlap", limits.overlap_mm, "Maximum depth of bone overlap [mm]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--gap", limits.gap_mm, "Maximum distance of a cut face from other bone [mm]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      .add_option("--support", limits.support_mm,
                  "Maximum distance of bone that supports a cut face [mm]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      .add_option("--support-fraction", limits.support_fraction,
                  "Minimum supported fraction of a segment's cut faces")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      .add_option("--root", limits.root_mm,
                  "Minimum distance of a cut from teeth and their roots [mm]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      .add_option(
          "--nerve-distance", limits.nerve_mm,
          "Minimum distance of a cut from the canals of --nerve, which are traced with errors "
          "of 1 to 5 mm [mm]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void add_optimize_command(CLI::App& plan, CommandContext& context) {
  const auto job = std::make_shared<pipeline::OptimizeJob>();
  const auto no_pictures = std::make_shared<bool>(false), no_check = std::make_shared<bool>(false);
  CLI::App* const command = plan.add_subcommand(
      "optimize", "Find the bone movements whose predicted face is closest to a target");
  mark_path(command->add_option("plan", job->plan, "Plan file (contract/plan.schema.json)"),
            PathKind::kPlan)
      ->required();
  mark_path(
      command->add_option("--target", job->target, "Target file (contract/target.schema.json)"),
      PathKind::kTarget)
      ->required();
  mark_path(command->add_option("-o,--output", job->output, "Folder for the results"),
            PathKind::kNewFolder)
      ->required();
  mark_path(command->add_option("--ct", job->ct, "The scan, instead of the one the plan names"),
            PathKind::kScan);
  command
      ->add_option("--corrections", job->max_corrections,
                   "Maximum number of solves of the model of the plan; 0: coarse model only")
      ->check(CLI::Range(0, 50))
      ->capture_default_str();
  command->add_flag("--no-gradient-check", *no_check,
                    "Skip the comparison of the gradient with differences");
  command->add_flag("--no-pictures", *no_pictures, "Skip the pictures");
  command->footer(
      "Example:\n"
      "  lefort plan optimize examples/midface_forward_clinical.json --ct ct.nrrd \\\n"
      "      --target examples/profile_target.json -o optimized/\n"
      "Writes plan.json, which lefort predict accepts, optimize.json, report.html, pictures/, and\n"
      "in prediction/ the full prediction of that plan. Not for clinical use.");
  command->callback([job, no_pictures, no_check, &context] {
    job->pictures = !*no_pictures;
    job->check_gradient = !*no_check;
    context.run("plan optimize",
                [&](Progress& progress) { return pipeline::optimize_plan(*job, progress); });
  });
}

}  // namespace

void add_plan_command(CLI::App& cli, CommandContext& context) {
  CLI::App* const plan =
      cli.add_subcommand("plan", "Osteotomies and bone movements: check, optimize");
  plan->require_subcommand(1);
  add_optimize_command(*plan, context);
  const auto job = std::make_shared<pipeline::CheckPlanJob>();
  const auto no_pictures = std::make_shared<bool>(false);
  CLI::App* const command = plan->add_subcommand(
      "check", "Check bone overlap, gaps and support of segments, without a prediction");
  mark_path(command->add_option("plan", job->plan, "Plan file (contract/plan.schema.json)"),
            PathKind::kPlan)
      ->required();
  mark_path(command->add_option("-o,--output", job->output, "Folder for the results"),
            PathKind::kNewFolder)
      ->required();
  CLI::Option* const ct =
      mark_path(command->add_option("--ct", job->ct, "The scan, instead of the one the plan names"),
                PathKind::kScan);
  mark_path(command->add_option(
                "--skull", job->skull,
                "Instead of a scan, a closed surface of the bone: .vtp, .stl, .ply or .obj"),
            PathKind::kSurface)
      ->excludes(ct);
  command->add_option("--nerve", job->nerve,
                      "nerve.json of `lefort nerve`: canals that cuts must not touch");
  command->add_flag("--no-pictures", *no_pictures, "Skip the pictures");
  add_limits(*command, job->limits);
  command->footer(
      "Example:\n"
      "  lefort plan check examples/le_fort_1.json --ct ct.nrrd -o check/\n"
      "Writes check.json, the bones after the movement, their transforms for 3D Slicer,\n"
      "pictures/, planned_movements.csv and worksheet.pdf for the operating room. If the plan has "
      "landmarks, also landmarks and cephalometry after the movement.\n"
      "Exit code 1 if there is a finding. Not for clinical use.");
  command->callback([job, no_pictures, &context] {
    job->pictures = !*no_pictures;
    bool has_findings = false;
    context.run("plan check", [&](Progress& progress) -> Result<pipeline::Summary> {
      LEFORT_TRY(pipeline::PlanCheckSummary done, pipeline::check_plan_file(*job, progress));
      has_findings = done.has_findings;
      return std::move(done.summary);
    });
    if (has_findings) context.exit_code = kExitFailed;
  });
}

}  // namespace lefort::app
