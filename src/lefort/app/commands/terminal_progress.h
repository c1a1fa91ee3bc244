/// \file
/// Progress on stderr: a bar on a terminal, otherwise a line per stage.
#pragma once

#include <lefort/core/progress.h>

#include <chrono>
#include <string>

namespace lefort::app {

class TerminalProgress final : public Progress {
 public:
  /// \param quiet  shows only notes.
  explicit TerminalProgress(bool quiet);
  ~TerminalProgress() override;

  void begin_stage(std::string_view name) override;
  void report(double fraction) override;
  void note(std::string_view sentence) override;
  [[nodiscard]] bool stop_requested() const override;

 private:
  [[nodiscard]] double seconds_in_stage() const;
  void end_stage();
  void clear_line() const;

  bool quiet_;
  bool is_terminal_;
  bool in_stage_ = false;
  int shown_percent_ = -1;
  std::string stage_;
  std::chrono::steady_clock::time_point begun_;
};

/// After this call, Ctrl-C, SIGTERM and a closed terminal request running work to stop; a second
/// Ctrl-C ends the program at once.
void stop_on_interrupt();

}  // namespace lefort::app
