/// \file
/// Profile of a command: its stages, and what takes time in them.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <filesystem>
#include <string>

namespace lefort::app {

/// Records the stages that it passes on, for core/trace.h.
class StageTrace final : public Progress {
 public:
  /// \param inner  receives all reports.
  explicit StageTrace(Progress& inner) : inner_(inner) {}
  ~StageTrace() override { end_stage(); }
  StageTrace(const StageTrace&) = delete;
  StageTrace& operator=(const StageTrace&) = delete;

  void begin_stage(std::string_view name) override;
  void report(double fraction) override { inner_.report(fraction); }
  void note(std::string_view sentence) override { inner_.note(sentence); }
  [[nodiscard]] bool stop_requested() const override { return inner_.stop_requested(); }

 private:
  void end_stage();

  Progress& inner_;
  std::string stage_ = "";
  double begin_us_ = 0.0;
};

/// Ends the record of core/trace.h and writes it as Chrome's trace events, which ui.perfetto.dev
/// and chrome://tracing show as a time line.
///
/// \param file  .json.
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_profile(const std::filesystem::path& file);

}  // namespace lefort::app
