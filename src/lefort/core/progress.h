/// \file
/// How long work tells how far it is, and learns that it should stop.
#pragma once

#include <string_view>

namespace lefort {

/// Told by functions that take over a second. The library itself never prints.
class Progress {
 public:
  virtual ~Progress() = default;

  /// A named part of the work begins, for example "mesh the soft tissue".
  virtual void begin_stage(std::string_view /*name*/) {}

  /// The share of the current stage that is done, 0 to 1. Called from the calling thread only.
  virtual void report(double /*fraction*/) {}

  /// Something the user should read: a warning, or what a choice left open was set to.
  virtual void note(std::string_view /*sentence*/) {}

  /// True once the work should end with ErrorCode::kCancelled. Safe from any thread.
  [[nodiscard]] virtual bool stop_requested() const { return false; }

  /// Listens to nothing and never stops.
  [[nodiscard]] static Progress& none();
};

}  // namespace lefort
