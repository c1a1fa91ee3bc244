#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/app/commands/profile.h>
#include <lefort/app/commands/slicer_progress.h>
#include <lefort/app/commands/terminal_progress.h>
#include <lefort/core/parallel.h>
#include <lefort/core/printable.h>
#include <lefort/core/trace.h>

#include <fmt/format.h>

namespace lefort::app {

void CommandContext::run(const std::string& command,
                         const std::function<Result<pipeline::Summary>(Progress&)>& work) {
  const ThreadLimit limit(threads);
  stop_on_interrupt();
  Result<pipeline::Summary> summary;
  const auto run_with = [&](Progress& progress) {
    if (profile.empty()) {
      summary = work(progress);
      return;
    }
    start_trace();
    {
      StageTrace traced(progress);
      summary = work(traced);
    }
    if (const auto written = write_profile(profile); !written && summary)
      summary = tl::unexpected(written.error());
  };
  if (slicer_progress) {
    SlicerProgress progress;
    run_with(progress);
  } else {
    TerminalProgress progress(quiet);
    run_with(progress);
  }
  if (!summary) {
    fmt::print(stderr, "lefort {}: {}\n", command, printable(summary.error().message));
    exit_code = kExitFailed;
    return;
  }
  if (json) {
    fmt::print("{}\n", summary->json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("{}\n", printable(summary->text, LineBreaks::kKept));
  }
}

void add_head_files(CLI::App& command, std::filesystem::path& ct,
                    std::optional<std::filesystem::path>& labels,
                    std::optional<std::filesystem::path>& landmarks,
                    const std::string& landmarks_are) {
  mark_path(command.add_option("ct", ct, "The CT: anything `lefort import` reads"), PathKind::kScan)
      ->required();
  mark_path(
      command.add_option("--labels", labels,
                         "Segmentation of the CT, .seg.nrrd; segmented automatically unless given"),
      PathKind::kLabels);
  mark_path(command.add_option("--landmarks", landmarks, landmarks_are), PathKind::kLandmarks);
}

}  // namespace lefort::app
