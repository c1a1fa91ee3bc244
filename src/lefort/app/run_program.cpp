#include <lefort/app/commands/command.h>
#include <lefort/app/commands/deprecated_options.h>
#include <lefort/app/reference/reference_options.h>
#include <lefort/app/run_program.h>
#include <lefort/core/printable.h>
#include <lefort/core/version.h>

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>

namespace lefort::app {
namespace {

int run_command(int argc, char** argv) {
  CLI::App cli{
      fmt::format(
          "lefort {}: from a head CT and a plan of bone movements to the predicted face.\n{}",
          kVersion, kNotForClinicalUse),
      "lefort"};
  CommandContext context;
  cli.set_version_flag("--version", kVersion);
  cli.fallthrough();
  cli.require_subcommand(1);
  cli.add_option("--threads", context.threads, "Threads; 0: all of the machine")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  cli.add_flag("--json", context.json, "Print the summary as JSON");
  cli.add_flag("--quiet", context.quiet, "Show no progress");
  cli.add_option("--profile", context.profile,
                 "File for the times of stages and of the work in them, Chrome trace JSON");
  cli.add_flag("--slicer-progress", context.slicer_progress)->group("");  // docs/guide/slicer.md
  cli.failure_message([](const CLI::App* app, const CLI::Error& error) {
    return fmt::format("{}: {} (see {} --help)\n", app->get_name(), error.what(), app->get_name());
  });
  add_import_command(cli, context);
  add_phantom_command(cli, context);
  add_segment_command(cli, context);
  add_field_command(cli, context);
  add_landmarks_command(cli, context);
  add_dental_command(cli, context);
  add_cephalogram_command(cli, context);
  add_nerve_command(cli, context);
  add_airway_command(cli, context);
  add_plan_command(cli, context);
  add_predict_command(cli, context);
  add_compare_command(cli, context);
  add_uncertainty_command(cli, context);
  add_run_command(cli, context);
  add_validate_command(cli, context);
  add_calibrate_command(cli, context);
  add_solve_command(cli, context);
  add_serve_command(cli, context);
  add_bench_command(cli, context);
  add_verify_command(cli, context);
  add_deprecated_options(cli);
  add_reference_options(cli);

  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return cli.exit(error) == 0 ? kExitDone : kExitUsage;
  }
  return context.exit_code;
}

}  // namespace

int run_program(int argc, char** argv) {
  try {
    return run_command(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("lefort: there is not enough memory\n", stderr);
  } catch (const std::exception& error) {
    fmt::print(stderr, "lefort: {}\n", printable(error.what()));
  }
  return kExitFailed;
}

}  // namespace lefort::app
