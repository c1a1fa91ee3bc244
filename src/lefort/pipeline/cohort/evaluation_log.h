/// \file
/// The log of an evaluation: what each attempt did, and when.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/file_lock.h>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace lefort::pipeline {

/// Begins of the lines that count attempts.
inline constexpr const char* kLogStarted = "started";
inline constexpr const char* kLogFinished = "finished";

/// Appends stages and notes to the locked log, and forwards them with the name of the evaluation.
/// An attempt that was killed ends without a line "finished" or "stopped".
class EvaluationLog final : public Progress {
 public:
  /// \param lock     of the log.
  /// \param name     of the evaluation.
  /// \param cleaned  returns a text without folders and file names, which may identify a person.
  /// \param inner    outlives this object.
  EvaluationLog(const io::FileLock& lock, std::string name,
                std::function<std::string(std::string)> cleaned, Progress& inner)
      : lock_(lock), name_(std::move(name)), cleaned_(std::move(cleaned)), inner_(inner) {}

  /// Appends a line with the time (UTC) and the number of the process.
  ///
  /// \returns nothing, or kFileUnwritable.
  [[nodiscard]] Result<void> add(std::string_view line) const;

  void begin_stage(std::string_view name) override;
  void report(double fraction) override { inner_.report(fraction); }
  void note(std::string_view sentence) override;
  [[nodiscard]] bool stop_requested() const override { return inner_.stop_requested(); }

 private:
  const io::FileLock& lock_;
  std::string name_;
  std::function<std::string(std::string)> cleaned_;
  Progress& inner_;
};

/// \returns the number of attempts that the log of an evaluation records; 0 without a log.
[[nodiscard]] int attempts_in(const std::filesystem::path& log);

}  // namespace lefort::pipeline
