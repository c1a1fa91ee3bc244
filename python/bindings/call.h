/// \file
/// Calls of long functions: progress, cancellation, threads, without the GIL.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/parallel.h>
#include <lefort/core/progress.h>

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "errors.h"

namespace lefort::python {

/// What a progress callback receives.
struct ProgressReport {
  std::string stage;
  double fraction = 0.0;
  std::optional<std::string> note;
};

/// Stops calls from another thread or from a progress callback.
class CancelToken {
 public:
  void cancel() { is_cancelled_ = true; }
  [[nodiscard]] bool is_cancelled() const { return is_cancelled_; }

 private:
  std::atomic<bool> is_cancelled_{false};
};

/// Arguments that all long functions have.
struct CallOptions {
  pybind11::object progress;  ///< None, or a callable.
  std::shared_ptr<CancelToken> cancel;
  int threads = 0;  ///< 0: all of the machine.
};

/// Passes reports to Python and handles its signals. Made with the GIL, used without.
class PythonProgress final : public Progress {
 public:
  explicit PythonProgress(const CallOptions& options);
  ~PythonProgress() override;
  PythonProgress(const PythonProgress&) = delete;
  PythonProgress& operator=(const PythonProgress&) = delete;

  void begin_stage(std::string_view name) override;
  void report(double fraction) override;
  void note(std::string_view sentence) override;
  [[nodiscard]] bool stop_requested() const override;

  /// Raises the exception of the callback or of a signal handler, if there was one. Needs the GIL.
  void raise_exception();
  /// Notes that are warnings, without the word.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void send(const std::optional<std::string>& note);
  void check_signals() const;

  pybind11::object callback_;
  std::shared_ptr<CancelToken> cancel_;
  std::string stage_;
  double fraction_ = 0.0;
  int sent_percent_ = -1;
  std::vector<std::string> warnings_;
  std::thread::id caller_ = std::this_thread::get_id();
  mutable std::chrono::steady_clock::time_point checked_ = std::chrono::steady_clock::now();
  mutable std::unique_ptr<pybind11::error_already_set> exception_;
  mutable std::atomic<bool> stop_{false};
};

/// Counts the calls that run, so that the end of the interpreter can wait for them.
class RunningCall {
 public:
  RunningCall();
  ~RunningCall();
  RunningCall(const RunningCall&) = delete;
  RunningCall& operator=(const RunningCall&) = delete;
};

/// While it exists, other threads of Python run. If the interpreter has begun to end, the
/// destructor does not return: Python would end the thread within C++.
class WithoutGil {
 public:
  WithoutGil() = default;
  ~WithoutGil();
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  RunningCall running_;
  pybind11::gil_scoped_release released_;
};

/// Runs work(progress) without the GIL.
///
/// \returns its value; raises its error, or the exception of the callback or of a signal handler.
template <class Work>
auto call(PythonProgress& progress, int threads, const Work& work) {
  using Returned = decltype(work(static_cast<Progress&>(progress)));
  if (threads < 0 || threads > 1024) raise_invalid("threads must be 0 to 1024");
  std::optional<Returned> result;
  {
    const WithoutGil without_gil;
    const ThreadLimit limit(threads);
    result.emplace(work(static_cast<Progress&>(progress)));
  }
  progress.raise_exception();
  return value_of(*std::move(result));
}
template <class Work>
auto call(const CallOptions& options, const Work& work) {
  PythonProgress progress(options);
  return call(progress, options.threads, work);
}

/// Adds Progress and CancelToken, and the clean-up at the end of the interpreter.
void bind_call(pybind11::module_& module);

}  // namespace lefort::python
