#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/guide.h>
#include <lefort/pipeline/optimize.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/variants.h>

#include <memory>
#include <string>
#include <vector>

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

CLI::Option* add_length(CLI::App& command, const std::string& name, double& value, double low,
                        double high, const std::string& meaning) {
  return command.add_option(name, value, meaning + " [mm]")
      ->check(CLI::Range(low, high))
      ->capture_default_str();
}

void add_guide_options(CLI::App& command, dental::GuideOptions& guide, dental::HoleOptions& holes) {
  add_length(command, "--clearance", guide.clearance_mm, 0.0, 0.5, "Between bone and guide");
  add_length(command, "--thickness", guide.thickness_mm, 2.0, 6.0, "Of the guide");
  add_length(command, "--width", guide.width_mm, 5.0, 20.0,
             "Of the guide, on each side of the cut");
  add_length(command, "--slot-clearance", guide.slot_clearance_mm, 0.0, 0.5,
             "On each side of the saw, which is as thick as the kerf of the plan");
  add_length(command, "--bridge", guide.bridge_mm, 2.0, 10.0,
             "Length without a slot at the ends and between slots");
  add_length(command, "--max-slot", guide.max_slot_mm, 5.0, 100.0, "Length of a slot at most");
  add_length(command, "--voxel", guide.voxel_mm, 0.1, 0.5, "Resolution");
  add_length(command, "--hole-diameter", holes.diameter_mm, 1.0, 4.0, "Of the drill");
  add_length(command, "--screw-diameter", holes.screw_mm, 1.0, 4.0, "Of the screws");
  add_length(command, "--hole-depth", holes.depth_mm, 2.0, 20.0, "Of the screws in the bone");
  add_length(command, "--hole-distance", holes.from_cut_mm, 3.0, 15.0,
             "Of the centers of the holes from the cut");
  add_length(command, "--hole-clearance", holes.min_clear_mm, 0.0, 10.0,
             "Minimum distance of the screws from tooth roots and nerves");
}

void add_guide_command(CLI::App& plan, CommandContext& context) {
  const auto job = std::make_shared<pipeline::GuideJob>();
  CLI::App* const command =
      plan.add_subcommand("guide", "Make cutting guides with slots and holes, to print");
  mark_path(command->add_option("plan", job->plan, "Plan file (contract/plan.schema.json)"),
            PathKind::kPlan)
      ->required();
  mark_path(
      command->add_option("-o,--output", job->output, "Folder for the guides and guides.json"),
      PathKind::kNewFolder)
      ->required();
  mark_path(command->add_option("--ct", job->ct, "The scan, instead of the one the plan names"),
            PathKind::kScan);
  command->add_option("--nerve", job->nerve,
                      "nerve.json of `lefort nerve`: canals that holes must not touch");
  command->add_option("--tooth-corrections", job->tooth_corrections,
                      "teeth_corrections.json of `lefort dental teeth`: corrected numbers");
  command->add_option("--segment", job->segment, "Only the guides of this segment");
  command
      ->add_option("--from", job->from,
                   "Side from which the guide is put on; unless given, right and left for a "
                   "sagittal split, otherwise anterior")
      ->check(CLI::IsMember({"anterior", "right", "left", "inferior"}));
  add_guide_options(*command, job->guide, job->holes);
  command->footer(
      "Example:\n"
      "  lefort plan guide examples/le_fort_1.json --ct ct.nrrd -o guides/\n"
      "Guide: docs/guide/cutting-guides.md. Not for clinical use.");
  command->callback([job, &context] {
    context.run("plan guide",
                [&](Progress& progress) { return pipeline::make_guides(*job, progress); });
  });
}

void add_variants_command(CLI::App& plan, CommandContext& context) {
  const auto job = std::make_shared<pipeline::VariantsJob>();
  CLI::App* const command =
      plan.add_subcommand("variants", "Put several plans of one case side by side");
  command
      ->add_option("folders", job->folders,
                   "Two to four folders, one for each plan and named by it: with check/ of `lefort "
                   "plan check`, and prediction/ of `lefort predict` if there is one")
      ->required()
      ->expected(2, 4);
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for variants.html, .pdf, .csv and .json"),
            PathKind::kNewFolder)
      ->required();
  command->footer(
      "Example:\n"
      "  lefort plan variants one-jaw/ two-jaws/ -o side-by-side/\n"
      "Not for clinical use.");
  command->callback([job, &context] {
    context.run("plan variants",
                [&](Progress& progress) { return pipeline::compare_variants(*job, progress); });
  });
}

}  // namespace

void add_plan_command(CLI::App& cli, CommandContext& context) {
  CLI::App* const plan = cli.add_subcommand(
      "plan", "Osteotomies and bone movements: check, optimize, guides, variants");
  plan->require_subcommand(1);
  add_optimize_command(*plan, context);
  add_guide_command(*plan, context);
  add_variants_command(*plan, context);
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
  command->add_option("--tooth-corrections", job->tooth_corrections,
                      "teeth_corrections.json of `lefort dental teeth`: corrected numbers");
  const auto splints = std::make_shared<std::vector<std::string>>(),
             guides = std::make_shared<std::vector<std::string>>();
  command->add_option("--splint", *splints,
                      "Splints of `lefort dental splint` to list in the worksheet");
  command->add_option("--guide", *guides, "Guides of `lefort plan guide` to list in the worksheet");
  command->add_flag("--no-pictures", *no_pictures, "Skip the pictures");
  add_limits(*command, job->limits);
  command->footer(
      "Example:\n"
      "  lefort plan check examples/le_fort_1.json --ct ct.nrrd -o check/\n"
      "Writes check.json, the bones after the movement, their transforms for 3D Slicer,\n"
      "pictures/, planned_movements.csv and worksheet.pdf for the operating room. If the plan has "
      "landmarks, also landmarks and cephalometry after the movement.\n"
      "Exit code 1 if there is a finding. Not for clinical use.");
  command->callback([job, no_pictures, splints, guides, &context] {
    job->pictures = !*no_pictures;
    for (const std::string& file : *splints) job->printed.push_back({"splint", file});
    for (const std::string& file : *guides) job->printed.push_back({"guide", file});
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
