/// \file
/// Progress reports and cancellation.
#pragma once

#include <string_view>

namespace lefort {

/// Receives reports from functions that take longer than a second. The library itself never prints.
class Progress {
 public:
  virtual ~Progress() = default;

  /// A named stage begins, for example "mesh the soft tissue"; this ends the previous stage.
  virtual void begin_stage(std::string_view /*name*/) {}

  /// Fraction of the current stage that is done, 0 to 1. Called only in the thread that called the
  /// reporting function.
  virtual void report(double /*fraction*/) {}

  /// A message for the user: a warning, or the value chosen for an option that was not set.
  virtual void note(std::string_view /*sentence*/) {}

  /// True if the task should end with ErrorCode::kCancelled. May be called from any thread.
  [[nodiscard]] virtual bool stop_requested() const { return false; }

  /// \returns an object that ignores reports and never stops.
  [[nodiscard]] static Progress& none();
};

}  // namespace lefort
