#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/dental.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lefort::app {
namespace {

void add_register(CLI::App& dental, CommandContext& context) {
  const auto job = std::make_shared<pipeline::RegisterArchesJob>();
  CLI::App* const command = dental.add_subcommand(
      "register", "Register intraoral scans with the crowns in a CT, without clicks");
  mark_path(command->add_option("ct", job->ct, "The CT: anything `lefort import` reads"),
            PathKind::kScan)
      ->required();
  mark_path(command->add_option("--upper", job->upper, "Intraoral scan of the upper jaw, in mm"),
            PathKind::kSurface);
  mark_path(command->add_option("--lower", job->lower, "Intraoral scan of the lower jaw, in mm"),
            PathKind::kSurface);
  mark_path(command->add_option(
                "--labels", job->labels,
                "Segmentation of the CT, .seg.nrrd; segmented automatically unless given"),
            PathKind::kLabels);
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for the scans in the frame of the CT and arches.json"),
            PathKind::kNewFolder)
      ->required();
  command->footer(
      "Example:\n"
      "  lefort dental register ct.nrrd --upper upper.stl --lower lower.stl -o arches/\n"
      "Guide: docs/guide/dental.md. Not for clinical use.");
  command->callback([job, &context] {
    context.run("dental",
                [&](Progress& progress) { return pipeline::register_arches(*job, progress); });
  });
}

/// Two numbers joined by a character, as "16=17".
CLI::Validator number_pair(char between) {
  const std::string form = std::string("NUMBER") + between + "NUMBER";
  return {[between, form](const std::string& text) -> std::string {
            const std::size_t at = text.find(between);
            const auto is_number = [](const std::string& part) {
              return !part.empty() && part.size() <= 2 &&
                     std::all_of(part.begin(), part.end(),
                                 [](unsigned char c) { return c >= '0' && c <= '9'; });
            };
            if (at != std::string::npos && is_number(text.substr(0, at)) &&
                is_number(text.substr(at + 1)))
              return {};
            return "'" + text + "' must be " + form + ", with FDI numbers";
          },
          form};
}

/// \pre `text` passed number_pair().
std::array<int, 2> pair_in(const std::string& text, char between) {
  const std::size_t at = text.find(between);
  return {std::stoi(text.substr(0, at)), std::stoi(text.substr(at + 1))};
}

void add_teeth(CLI::App& dental, CommandContext& context) {
  const auto job = std::make_shared<pipeline::TeethJob>();
  const auto numbers = std::make_shared<std::vector<std::string>>();
  CLI::App* const command =
      dental.add_subcommand("teeth", "Separate the teeth in a CT and number them (FDI)");
  add_head_files(*command, job->ct, job->labels, job->landmarks);
  command
      ->add_option("--correct", *numbers,
                   "Correct a number: FOUND=FDI, 0 if it is no tooth; may be repeated")
      ->allow_extra_args(false)
      ->check(number_pair('='));
  command->add_option("--corrections", job->corrections,
                      "teeth_corrections.json of an earlier run: corrected numbers");
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for the numbered teeth, their axes and teeth.json"),
            PathKind::kNewFolder)
      ->required();
  command->footer(
      "Example:\n"
      "  lefort dental teeth ct.nrrd -o teeth/\n"
      "Guide: docs/guide/dental.md. Not for clinical use.");
  command->callback([job, numbers, &context] {
    for (const std::string& one : *numbers) {
      const auto [found, fdi] = pair_in(one, '=');
      job->more_corrections.push_back({found, fdi});
    }
    context.run("dental",
                [&](Progress& progress) { return pipeline::number_teeth_of_scan(*job, progress); });
  });
}

void add_arches(CLI::App& command, std::filesystem::path& upper, std::filesystem::path& lower,
                std::optional<std::filesystem::path>& arches) {
  mark_path(command.add_option("upper", upper, "Surface of the upper arch"), PathKind::kSurface)
      ->required();
  mark_path(command.add_option("lower", lower, "Surface of the lower arch, in the same frame"),
            PathKind::kSurface)
      ->required();
  command.add_option("--arches", arches,
                     "arches.json of `lefort dental register`, for the directions of the arches; "
                     "without it they are those of the patient");
}

void add_requests(CLI::App& command, dental::OcclusionRequests& requests) {
  const CLI::Range range(-dental::kMaxRequest_mm, dental::kMaxRequest_mm);
  command
      .add_option("--midline", requests.midline_mm,
                  "Requested lower midline from the upper one, to the left [mm]; needs --teeth")
      ->check(range);
  command.add_option("--overjet", requests.overjet_mm, "Requested overjet, edge to edge [mm]")
      ->check(range);
  command.add_option("--overbite", requests.overbite_mm, "Requested overbite, edge to edge [mm]")
      ->check(range);
}

void add_occlusion(CLI::App& dental, CommandContext& context) {
  const auto job = std::make_shared<pipeline::OcclusionJob>();
  const auto cuts = std::make_shared<std::vector<std::string>>();
  CLI::App* const command =
      dental.add_subcommand("occlusion", "Find the maximum intercuspation of two arches");
  add_arches(*command, job->upper, job->lower, job->arches);
  command
      ->add_option("--shift", job->options.shift_mm,
                   "Distance of the starts of the search in the occlusal plane [mm]")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
  command
      ->add_option("--yaw", job->options.yaw_deg, "Yaw between the starts of the search [degrees]")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command
      ->add_option("--bite", job->bites,
                   "Scan of the teeth in occlusion, from the cheek, in mm: the occlusion is "
                   "that of the scan; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--as-scanned", job->is_as_scanned,
                    "The occlusion is that of the files of the intraoral scans; needs --arches");
  command
      ->add_option("--cut", *cuts,
                   "Cut the upper arch between two teeth (FDI numbers), as 12-13: each piece gets "
                   "its own occlusion; may be repeated once")
      ->allow_extra_args(false)
      ->check(number_pair('-'));
  command->add_option("--teeth", job->teeth,
                      "teeth.json of `lefort dental teeth`: relations of midlines, canines and "
                      "molars; for --cut and --midline");
  add_requests(*command, job->options.requests);
  command->add_option(
      "--upper-transform", job->upper_transform,
      "Planned motion of the upper jaw, .tfm, as segment_maxilla.tfm of `lefort plan "
      "check`: also writes lower_with_upper.tfm, the motion of the mandible to the "
      "occlusion with the moved maxilla, for its path in the plan");
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for the lower arch in occlusion, contacts and transform"),
            PathKind::kNewFolder)
      ->required();
  command->footer(
      "Example:\n"
      "  lefort dental occlusion arches/upper.stl arches/lower.stl --arches arches/arches.json "
      "-o occlusion/\n"
      "Guide: docs/guide/dental.md. Not for clinical use.");
  command->callback([job, cuts, &context] {
    for (const std::string& one : *cuts) job->cuts.push_back(pair_in(one, '-'));
    context.run("dental",
                [&](Progress& progress) { return pipeline::find_arch_occlusion(*job, progress); });
  });
}

void add_splint_options(CLI::App& command, dental::SplintOptions& options) {
  command.add_option("--clearance", options.clearance_mm, "Between crowns and splint [mm]")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      .add_option("--cover", options.cover_mm, "Height of the crowns that the splint covers [mm]")
      ->check(CLI::Range(0.5, 6.0))
      ->capture_default_str();
  command
      .add_option("--wall", options.wall_mm,
                  "Width beyond the covered crowns, between the arches [mm]")
      ->check(CLI::Range(1.0, 6.0))
      ->capture_default_str();
  command.add_option("--rim", options.rim_mm, "Width beside the crowns [mm]")
      ->check(CLI::Range(1.0, 6.0))
      ->capture_default_str();
  command.add_option("--edge", options.edge_mm, "Radius of the edges [mm]")
      ->check(CLI::Range(0.0, 3.0))
      ->capture_default_str();
  command.add_option("--voxel", options.voxel_mm, "Resolution [mm]")
      ->check(CLI::Range(0.1, 0.5))
      ->capture_default_str();
}

void add_splint(CLI::App& dental, CommandContext& context) {
  const auto job = std::make_shared<pipeline::SplintJob>();
  CLI::App* const command =
      dental.add_subcommand("splint", "Make a splint between two arches, to print");
  add_arches(*command, job->upper, job->lower, job->arches);
  command->add_option("--upper-transform", job->upper_transform,
                      "Motion of the upper arch to the planned position, .tfm");
  command->add_option("--lower-transform", job->lower_transform, "The same of the lower arch");
  command
      ->add_option("--open", job->open_mm,
                   "Move the lower arch to inferior before, if the teeth touch [mm]")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  add_splint_options(*command, job->options);
  command->add_option("--text", job->text, "Engraved into the front; 16 letters or fewer");
  mark_path(command->add_option("-o,--output", job->output,
                                "Folder for splint.stl, splint.3mf and splint.json"),
            PathKind::kNewFolder)
      ->required();
  command->footer(
      "Example:\n"
      "  lefort dental splint arches/upper.stl occlusion/lower.stl --arches arches/arches.json "
      "--open 2 -o splint/\n"
      "Guide: docs/guide/dental.md. Not for clinical use.");
  command->callback([job, &context] {
    context.run("dental",
                [&](Progress& progress) { return pipeline::make_arch_splint(*job, progress); });
  });
}

}  // namespace

void add_dental_command(CLI::App& cli, CommandContext& context) {
  CLI::App* const dental =
      cli.add_subcommand("dental", "Numbered teeth, intraoral scans, occlusion, splints");
  dental->require_subcommand(1);
  add_teeth(*dental, context);
  add_register(*dental, context);
  add_occlusion(*dental, context);
  add_splint(*dental, context);
}

}  // namespace lefort::app
