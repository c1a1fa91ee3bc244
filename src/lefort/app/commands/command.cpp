#include <lefort/app/commands/command.h>
#include <lefort/app/commands/slicer_progress.h>
#include <lefort/app/commands/terminal_progress.h>
#include <lefort/core/parallel.h>
#include <lefort/core/printable.h>

#include <fmt/format.h>

namespace lefort::app {

void CommandContext::run(const std::string& command,
                         const std::function<Result<pipeline::Summary>(Progress&)>& work) {
  const ThreadLimit limit(threads);
  stop_on_interrupt();
  Result<pipeline::Summary> summary;
  if (slicer_progress) {
    SlicerProgress progress;
    summary = work(progress);
  } else {
    TerminalProgress progress(quiet);
    summary = work(progress);
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

}  // namespace lefort::app
