#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/bench/contact_bench.h>
#include <lefort/bench/detection.h>
#include <lefort/bench/field_process.h>
#include <lefort/bench/field_scaling.h>
#include <lefort/bench/solve_block.h>
#include <lefort/bench/solve_task.h>
#include <lefort/bench/table1.h>
#include <lefort/pipeline/verify.h>

#include <memory>
#include <string>

namespace lefort::app {
namespace {

void add_table1(CLI::App& bench, CommandContext& context) {
  const auto options = std::make_shared<bench::Table1Options>();
  CLI::App* const command = bench.add_subcommand(
      "table1", "Reproduce the paper's Table 1: distance fields of a skull, with other libraries");
  mark_path(command->add_option("ct", options->ct, "The scan: anything `lefort import` reads"),
            PathKind::kScan)
      ->required();
  mark_path(command->add_option(
                "-o,--output", options->output,
                "Folder for skull.vtp (used again if there) and table1.md, .csv, .json, .html"),
            PathKind::kNewFolder)
      ->required();
  command->add_option("--resolution", options->resolutions, "Cells along each side of the cube")
      ->check(CLI::IsMember({64, 128, 256, 512, 1024, 2048}))
      ->capture_default_str();
  command->add_option("--method", options->methods, "Methods to run")
      ->check(
          CLI::IsMember({"bricks", "hybrid", "adaptive", "uniform", "openvdb", "embree", "cgal"}))
      ->capture_default_str();
  command->add_option("--repeats", options->repeats, "Builds; their median is reported")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->footer("Example:\n  lefort bench table1 ct.nrrd -o table1/");
  command->callback([options, &context] {
    context.run("bench table1", [&](Progress& progress) -> Result<pipeline::Summary> {
      LEFORT_TRY(const std::string table, bench::run_table1(*options, progress));
      return pipeline::Summary{.text = table, .json = {{"output", options->output.string()}}};
    });
  });
}

void add_scaling(CLI::App& bench, CommandContext& context) {
  const auto options = std::make_shared<bench::ScalingOptions>();
  const auto without_peer = std::make_shared<bool>(false);
  CLI::App* const command = bench.add_subcommand(
      "scaling",
      "Measure how distance fields of a skull scale with band, resolution and triangles");
  mark_path(command->add_option("ct", options->ct, "The scan: anything `lefort import` reads"),
            PathKind::kScan)
      ->required();
  mark_path(command->add_option(
                "-o,--output", options->output,
                "Folder for skull.vtp (used again if there) and scaling.md, .csv, .json, .html"),
            PathKind::kNewFolder)
      ->required();
  command->add_option("--band", options->bands, "Half widths of the band, in cells")
      ->check(CLI::Range(2, 24))
      ->capture_default_str();
  command->add_option("--resolution", options->resolutions, "Cells along each side of the cube")
      ->check(CLI::IsMember({64, 128, 256, 512, 1024, 2048}))
      ->capture_default_str();
  command
      ->add_option("--subdivisions", options->parts,
                   "Subdivisions of each triangle edge: 11 gives 11.6 million triangles")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  command->add_flag("--without-openvdb", *without_peer, "Measure the fields of lefort only");
  command->add_option("--repeats", options->repeats, "Builds; their median is reported")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->footer("Example:\n  lefort bench scaling ct.nrrd -o scaling/");
  command->callback([options, without_peer, &context] {
    context.run("bench scaling", [&](Progress& progress) -> Result<pipeline::Summary> {
      options->with_openvdb = !*without_peer;
      LEFORT_TRY(const std::string table, bench::run_field_scaling(*options, progress));
      return pipeline::Summary{.text = table, .json = {{"output", options->output.string()}}};
    });
  });
}

void add_convergence(CLI::App& bench, CommandContext& context) {
  const auto job = std::make_shared<pipeline::ConvergenceJob>();
  const auto no_synthetic = std::make_shared<bool>(false);
  CLI::App* const command = bench.add_subcommand(
      "convergence", "Reproduce the paper's Figure 5: contact detection by fields and by a BVH");
  mark_path(command->add_option("plans", job->plans, "Plan files; none: only the synthetic cases"),
            PathKind::kPlan);
  mark_path(command->add_option("--ct", job->ct, "The scan, instead of the ones the plans name"),
            PathKind::kScan);
  mark_path(command->add_option(
                "-o,--output", job->output,
                "Folder for convergence.md, .csv, plots, and the cache of prepared cases"),
            PathKind::kNewFolder)
      ->required();
  command->add_option("--method", job->methods, "Which to run, by name; all unless given");
  command
      ->add_option(
          "--element-size", job->element_size_mm,
          "Edge of elements near the mobilized segments [mm], instead of the plans'; those far "
          "away are scaled alike")
      ->check(CLI::Range(0.5, 20.0));
  command
      ->add_option("--steps", job->steps,
                   "Numbers of steps to run each plan with, instead of its own; reports the "
                   "distance between the faces")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--no-synthetic", *no_synthetic, "Only the plans");
  command->footer(
      "Example:\n  lefort bench convergence examples/midface_forward.json "
      "examples/midface_forward_down.json --ct ct.nrrd -o convergence/\n"
      "Results: docs/studies/contact-on-a-real-head.md.");
  command->callback([job, no_synthetic, &context] {
    job->synthetic = !*no_synthetic;
    context.run("bench convergence",
                [&](Progress& progress) { return pipeline::bench_convergence(*job, progress); });
  });
}

void add_landmarks(CLI::App& bench, CommandContext& context) {
  const auto job = std::make_shared<pipeline::LandmarkBenchJob>();
  CLI::App* const command = bench.add_subcommand(
      "landmarks", "Measure automatic landmarks on synthetic heads of known shape");
  command->add_option("--heads", job->heads, "Number of heads of random shape")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command
      ->add_option("--seed", job->seed,
                   "Seed of the first head; each further head has the next number")
      ->capture_default_str();
  command->add_option("--voxel", job->voxel_mm, "Edge of a voxel [mm]")
      ->check(CLI::Range(0.4, 3.0))
      ->capture_default_str();
  command->add_option("--noise", job->noise_hu, "Standard deviation of the noise [HU]")
      ->check(CLI::Range(0.0, 200.0))
      ->capture_default_str();
  mark_path(command->add_option("-o,--output", job->output, "The errors, .csv"),
            PathKind::kNewTable)
      ->required();
  mark_path(
      command->add_option("--scans", job->scans,
                          "Folder for scans, labels and true landmarks; not written unless given"),
      PathKind::kNewFolder);
  command->footer("Example:\n  lefort bench landmarks --heads 50 -o landmark_errors.csv");
  command->callback([job, &context] {
    context.run("bench landmarks",
                [&](Progress& progress) { return pipeline::bench_landmarks(*job, progress); });
  });
}

void add_dental(CLI::App& bench, CommandContext& context) {
  const auto job = std::make_shared<pipeline::DentalBenchJob>();
  CLI::App* const command = bench.add_subcommand(
      "dental", "Measure teeth, scans, occlusion, splints and canals on synthetic heads");
  command->add_option("--heads", job->heads, "Number of heads of random shape")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--seed", job->seed,
                   "Seed of the first head; each further head has the next number")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command
      ->add_option("--starts", job->starts,
                   "Random frames of the scans and positions of the lower arch of each head")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--voxel", job->voxel_mm, "Edge of a voxel [mm]")
      ->check(CLI::Range(0.3, 1.0))
      ->capture_default_str();
  command->add_option("--noise", job->noise_hu, "Standard deviation of the noise [HU]")
      ->check(CLI::Range(0.0, 200.0))
      ->capture_default_str();
  mark_path(command->add_option("-o,--output", job->output, "The figures, .csv"),
            PathKind::kNewTable)
      ->required();
  command->footer("Example:\n  lefort bench dental --heads 5 --starts 10 -o dental.csv");
  command->callback([job, &context] {
    context.run("bench dental",
                [&](Progress& progress) { return pipeline::bench_dental(*job, progress); });
  });
}

void add_preview(CLI::App& bench, CommandContext& context) {
  const auto job = std::make_shared<pipeline::PreviewBenchJob>();
  CLI::App* const command = bench.add_subcommand(
      "preview", "Measure the preview of the face while the bones of a plan move");
  mark_path(command->add_option("plan", job->plan, "The plan"), PathKind::kPlan)->required();
  mark_path(command->add_option("--ct", job->ct, "The scan: anything `lefort import` reads"),
            PathKind::kScan)
      ->required();
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for preview_bench.json and the cached stages"),
            PathKind::kNewFolder)
      ->required();
  mark_path(command->add_option("--prediction", job->prediction,
                                "Result folder of `lefort predict` with the same plan and scan: "
                                "the preview is compared with it"),
            PathKind::kFolder);
  command->add_option("--frame", job->frame_mm, "Motion between two updates [mm]")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  command->footer(
      "Example:\n  lefort bench preview plan.json --ct ct.nrrd --prediction forward/ -o preview/");
  command->callback([job, &context] {
    context.run("bench preview",
                [&](Progress& progress) { return pipeline::bench_preview(*job, progress); });
  });
}

void add_all(CLI::App& bench, CommandContext& context) {
  const auto job = std::make_shared<pipeline::BenchAllJob>();
  CLI::App* const command = bench.add_subcommand(
      "all", "Run the benchmarks with their peers, and compare the ratios with stored ones");
  mark_path(command->add_option("ct", job->ct, "The scan: anything `lefort import` reads"),
            PathKind::kScan)
      ->required();
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for bench.md, .json, .svg and the files of each benchmark"),
            PathKind::kNewFolder)
      ->required();
  mark_path(command->add_option("--plan", job->plan,
                                "Also measure the prediction and the preview of this plan"),
            PathKind::kPlan);
  mark_path(command->add_option(
                "--against", job->against,
                "bench.json of an earlier run: exit code 1 if a ratio is lower or missing"),
            PathKind::kParameters);
  command->add_option("--threshold", job->threshold, "Allowed loss of a ratio, as a fraction")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--resolution", job->resolutions, "Cells along each side of the fields")
      ->check(CLI::IsMember({64, 128, 256, 512, 1024}))
      ->capture_default_str();
  command
      ->add_option("--comparison-cells", job->comparison_cells,
                   "Cells along a side of the block of the comparison with CalculiX")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command
      ->add_option("--repeats", job->repeats,
                   "Builds of fields and runs of CalculiX; their medians are reported")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->footer(
      "Example:\n  lefort bench all ct.nrrd -o bench/ --plan "
      "examples/midface_forward_clinical.json "
      "--against before/bench.json");
  command->callback([job, &context] {
    bool passed = true;
    context.run("bench all", [&](Progress& progress) -> Result<pipeline::Summary> {
      LEFORT_TRY(const pipeline::BenchSummary done, pipeline::bench_all(*job, progress));
      passed = done.passed;
      return done.summary;
    });
    if (!passed) context.exit_code = kExitFailed;
  });
}

void add_detection(CLI::App& bench, CommandContext& context) {
  const auto options = std::make_shared<bench::DetectionOptions>();
  CLI::App* const command = bench.add_subcommand(
      "detection",
      "Measure contact detection with a skull: fields and bounding volume hierarchies");
  mark_path(command->add_option("ct", options->ct, "The scan: anything `lefort import` reads"),
            PathKind::kScan)
      ->required();
  mark_path(command->add_option("-o,--output", options->output,
                                "Folder for skull.vtp (used again if there) and detection.md"),
            PathKind::kNewFolder)
      ->required();
  command->add_option("--points", options->points, "Points in a query")
      ->check(CLI::Range(1, 100'000'000))
      ->capture_default_str();
  command->add_option("--resolution", options->resolution, "Cells along a side of the field")
      ->check(CLI::IsMember({64, 128, 256, 512, 1024}))
      ->capture_default_str();
  command->footer("Example:\n  lefort bench detection ct.nrrd -o detection/");
  command->callback([options, &context] {
    if (context.threads > 0) options->threads = context.threads;
    context.run("bench detection", [&](Progress& progress) -> Result<pipeline::Summary> {
      LEFORT_TRY(const std::string table, bench::run_detection(*options, progress));
      return pipeline::Summary{.text = table, .json = {{"output", options->output.string()}}};
    });
  });
}

void add_solve(CLI::App& bench, CommandContext& context) {
  const auto options = std::make_shared<bench::SolveOptions>();
  CLI::App* const command = bench.add_subcommand(
      "solve", "Solve blocks of soft tissue: compared with CalculiX, and of increasing size");
  mark_path(command->add_option("-o,--output", options->output, "Folder for solve.md, .csv, .json"),
            PathKind::kNewFolder)
      ->required();
  command->add_option("--repeats", options->repeats, "Runs of CalculiX and of lefort; 0: none")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  command
      ->add_option("--comparison-cells", options->pair_cells,
                   "Cells along a side of the block of the comparison with CalculiX")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--increments", options->increments, "Number of load increments")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command
      ->add_option("--cells", options->growth_cells,
                   "Cells along a side of blocks of increasing size")
      ->check(CLI::Range(1, 80))
      ->capture_default_str();
  command->add_flag("--large", options->large, "Also a block of a million unknowns");
  command->footer("Example:\n  lefort bench solve -o solve/");
  command->callback([options, &context] {
    if (context.threads > 0) options->threads = context.threads;
    context.run("bench solve", [&](Progress& progress) -> Result<pipeline::Summary> {
      LEFORT_TRY(const std::string table, bench::run_solve_bench(*options, progress));
      return pipeline::Summary{.text = table, .json = {{"output", options->output.string()}}};
    });
  });
}

void add_contact(CLI::App& bench, CommandContext& context) {
  const auto options = std::make_shared<bench::ContactBenchOptions>();
  const auto without_peer = std::make_shared<bool>(false);
  CLI::App* const command = bench.add_subcommand(
      "contact", "Press a ball into a block and slide it along: compared with CalculiX");
  mark_path(command->add_option("-o,--output", options->output,
                                "Folder for contact.md, .json and the files of CalculiX"),
            PathKind::kNewFolder)
      ->required();
  command->add_option("--repeats", options->repeats, "Runs of lefort; their median is reported")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_flag("--without-calculix", *without_peer, "Measure lefort only");
  command->footer("Example:\n  lefort bench contact -o contact/");
  command->callback([options, without_peer, &context] {
    if (context.threads > 0) options->threads = context.threads;
    options->with_peer = !*without_peer;
    context.run("bench contact", [&](Progress& progress) -> Result<pipeline::Summary> {
      LEFORT_TRY(const std::string table, bench::run_contact_bench(*options, progress));
      return pipeline::Summary{.text = table, .json = {{"output", options->output.string()}}};
    });
  });
}

/// A single measurement, in a process started by `bench solve`.
void add_solve_task(CLI::App& bench, CommandContext& context) {
  const auto task = std::make_shared<std::string>();
  CLI::App* const command = bench.add_subcommand("solve-task", "One measurement, as JSON");
  command->group("");  // Not listed.
  command->add_option("task", *task)->required();
  command->callback([task, &context] {
    context.run("bench solve-task", [&](Progress&) -> Result<pipeline::Summary> {
      LEFORT_TRY(const auto result, bench::run_solve_task(*task));
      return pipeline::Summary{.text = result.dump(1), .json = result};
    });
  });
}

/// A single measurement, in a process started by the other benchmarks.
void add_field_task(CLI::App& bench, CommandContext& context) {
  struct Job {
    std::string surface, task;
  };
  const auto job = std::make_shared<Job>();
  CLI::App* const command = bench.add_subcommand("field-task", "One measurement, as JSON");
  command->group("");  // Not listed.
  command->add_option("surface", job->surface)->required();
  command->add_option("task", job->task)->required();
  command->callback([job, &context] {
    context.run("bench field-task", [&](Progress&) -> Result<pipeline::Summary> {
      LEFORT_TRY(const auto result, bench::run_field_task(job->surface, job->task));
      return pipeline::Summary{.text = result.dump(1), .json = result};
    });
  });
}

}  // namespace

void add_bench_command(CLI::App& cli, CommandContext& context) {
  CLI::App* const bench = cli.add_subcommand("bench", "Run benchmarks");
  bench->require_subcommand(1);
  add_all(*bench, context);
  add_table1(*bench, context);
  add_scaling(*bench, context);
  add_convergence(*bench, context);
  add_landmarks(*bench, context);
  add_dental(*bench, context);
  add_preview(*bench, context);
  add_detection(*bench, context);
  add_field_task(*bench, context);
  add_solve(*bench, context);
  add_solve_task(*bench, context);
  add_contact(*bench, context);
}

}  // namespace lefort::app
