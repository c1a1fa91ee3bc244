#include <lefort/app/commands/terminal_progress.h>
#include <lefort/core/printable.h>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>

namespace lefort::app {
namespace {

constexpr double kNoTime_s = 0.05;  // Shown as 0.0 s.

std::atomic<bool> interrupted{false};  // Set by the signal handler.
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_interrupt(int signal) {
  interrupted = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void stop_on_interrupt() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  // A closed terminal, so that temporary files are removed; nohup ignores it.
  if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

TerminalProgress::TerminalProgress(bool quiet)
    : quiet_(quiet), is_terminal_(::isatty(STDERR_FILENO) != 0) {}

TerminalProgress::~TerminalProgress() { end_stage(); }

void TerminalProgress::begin_stage(std::string_view name) {
  if (seconds_in_stage() < kNoTime_s) in_stage_ = false;  // An empty stage is not shown.
  end_stage();
  stage_ = printable(name);
  in_stage_ = true;
  shown_percent_ = -1;
  begun_ = std::chrono::steady_clock::now();
  report(0.0);
}

void TerminalProgress::report(double fraction) {
  constexpr int kBarLength = 30;
  if (quiet_ || !is_terminal_ || !in_stage_) return;
  const int percent = int(std::clamp(fraction, 0.0, 1.0) * 100.0);
  if (percent == shown_percent_) return;
  shown_percent_ = percent;
  const int filled = percent * kBarLength / 100;
  fmt::print(stderr, "\r{:<28.28} [{:=<{}}{:<{}}] {:3d} %", stage_, "", filled, "",
             kBarLength - filled, percent);
  std::fflush(stderr);
}

void TerminalProgress::note(std::string_view sentence) {
  clear_line();
  fmt::print(stderr, "{}\n", printable(sentence));
  shown_percent_ = -1;
}

bool TerminalProgress::stop_requested() const { return interrupted; }

double TerminalProgress::seconds_in_stage() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
}

void TerminalProgress::clear_line() const {
  if (is_terminal_ && in_stage_ && !quiet_) fmt::print(stderr, "\r{:70}\r", "");
}

void TerminalProgress::end_stage() {
  if (!in_stage_) return;
  clear_line();
  in_stage_ = false;
  const double seconds = seconds_in_stage();
  if (!quiet_) fmt::print(stderr, "{:<34} {:6.1f} s\n", stage_, seconds);
}

}  // namespace lefort::app
