#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/uncertainty.h>

#include <fmt/format.h>

#include <charconv>
#include <memory>
#include <string>

namespace lefort::app {
namespace {

/// "2/8". \returns nothing for another text.
std::optional<pipeline::SampleChunk> parse_chunk(const std::string& text) {
  pipeline::SampleChunk chunk;
  const char* const end = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), end, chunk.number);
  if (error != std::errc() || slash == end || *slash != '/') return std::nullopt;
  const auto [last, error_of_count] = std::from_chars(slash + 1, end, chunk.count);
  if (error_of_count != std::errc() || last != end) return std::nullopt;
  return chunk;
}

std::string check_chunk(const std::string& text) {
  return parse_chunk(text) ? std::string() : "must be NUMBER/COUNT, for example 2/8: " + text;
}

}  // namespace

void add_uncertainty_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::UncertaintyJob>();
  const auto no_pictures = std::make_shared<bool>(false);
  const auto show_inputs = std::make_shared<bool>(false);
  const auto chunk = std::make_shared<std::string>();
  CLI::App* const command = cli.add_subcommand(
      "uncertainty", "Band of the predicted face by the uncertainty of named inputs");
  mark_path(command->add_option("plan", job->plan, "Plan file (contract/plan.schema.json)"),
            PathKind::kPlan)
      ->required();
  CLI::Option* const output =
      mark_path(command->add_option("-o,--output", job->output, "Folder for the results"),
                PathKind::kNewFolder);
  mark_path(command->add_option("--ct", job->ct, "The scan, instead of the one the plan names"),
            PathKind::kScan);
  mark_path(
      command->add_option("--inputs", job->inputs,
                          "Distributions of the inputs (contract/uncertain_inputs.schema.json)"),
      PathKind::kInputs);
  CLI::Option* const show = command->add_flag(
      "--show-inputs", *show_inputs, "Print the default inputs of the plan, and compute nothing");
  command->add_option("--samples", job->samples, "Samples of the coarse model, 20 to 20000")
      ->capture_default_str();
  command
      ->add_option("--fine", job->fine_samples,
                   "Samples of the plan's mesh for the correction; 0, or 3 or more")
      ->capture_default_str();
  command->add_option("--seed", job->seed, "Of all random numbers")->capture_default_str();
  command
      ->add_option("--path-checks", job->path_checks,
                   "Samples that are also solved along the whole path")
      ->capture_default_str();
  command
      ->add_option("--chunk", *chunk,
                   "Solve one of several parts of the samples, for example 2/8, and write no "
                   "results; a run without --chunk finds the solved samples")
      ->check(check_chunk);
  command->add_flag("--no-pictures", *no_pictures, "Skip the pictures");
  show->excludes(output);
  command->footer(
      "Examples:\n"
      "  lefort uncertainty plan.json --show-inputs > inputs.json\n"
      "  lefort uncertainty plan.json --ct ct.nrrd -o band/ --inputs inputs.json --samples 200\n"
      "Writes report.html, uncertainty.json, samples.csv, uncertainty.vtp, inputs.json and\n"
      "pictures/. Solved samples are stored in samples/ there, and found again while their inputs\n"
      "are unchanged. The band covers only the named inputs. Not for clinical use.");
  command->callback([job, no_pictures, show_inputs, chunk, output, &context] {
    if (*show_inputs) {
      context.run("uncertainty",
                  [&](Progress&) { return pipeline::default_uncertain_inputs(job->plan); });
      return;
    }
    if (output->empty()) throw CLI::RequiredError("--output");
    job->pictures = !*no_pictures;
    if (!chunk->empty()) job->chunk = parse_chunk(*chunk);
    context.run("uncertainty",
                [&](Progress& progress) { return pipeline::quantify_uncertainty(*job, progress); });
  });
}

}  // namespace lefort::app
