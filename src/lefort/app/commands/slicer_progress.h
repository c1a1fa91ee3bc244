/// \file
/// Progress on stdout in the elements that 3D Slicer reads.
#pragma once

#include <lefort/app/commands/terminal_progress.h>
#include <lefort/core/progress.h>

#include <chrono>
#include <string>
#include <string_view>

namespace lefort::app {

/// A stage is a filter of the Slicer Execution Model: its name, the fraction done, its time. Notes
/// go to stderr.
class SlicerProgress final : public Progress {
 public:
  ~SlicerProgress() override;

  void begin_stage(std::string_view name) override;
  void report(double fraction) override;
  void note(std::string_view sentence) override;
  [[nodiscard]] bool stop_requested() const override;

 private:
  void end_stage();

  TerminalProgress terminal_{true};  ///< Notes and interruption.
  bool in_stage_ = false;
  int shown_percent_ = -1;
  std::string stage_;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace lefort::app
