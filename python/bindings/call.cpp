#include "call.h"

#include <lefort/core/printable.h>
#include <lefort/io/start_readers.h>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "docstring.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;

constexpr auto kSignalInterval = 50ms;  // Ctrl-C is noticed within this.
constexpr auto kLongestExit = 20s;      // Of a call that has been cancelled.
constexpr std::string_view kWarning = "warning: ";

std::atomic<bool> interpreter_ends{false};
std::atomic<std::thread::id> ending_thread{};
std::atomic<int> running_calls{0};

/// Whether this thread must not use Python any more. The thread that ends the interpreter may:
/// other functions that are called at its end follow.
bool is_too_late() {
  return interpreter_ends && std::this_thread::get_id() != ending_thread.load();
}

/// Cancels all calls, waits until they have ended, and ends the readers of files. Threads that run
/// when the interpreter ends would otherwise be ended within C++.
void shut_down() {
  ending_thread = std::this_thread::get_id();
  interpreter_ends = true;
  const py::gil_scoped_release released;
  const auto until = std::chrono::steady_clock::now() + kLongestExit;
  while (running_calls > 0 && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(5ms);
  if (running_calls == 0) io::stop_readers();
}

std::string describe(const ProgressReport& report) {
  return fmt::format("<lefort.Progress: {}, {:.0f} %{}>", report.stage, 100.0 * report.fraction,
                     report.note ? ": " + *report.note : "");
}

}  // namespace

RunningCall::RunningCall() { ++running_calls; }
RunningCall::~RunningCall() { --running_calls; }

WithoutGil::~WithoutGil() {
  if (!is_too_late()) return;
  --running_calls;
  while (true) std::this_thread::sleep_for(1h);
}

PythonProgress::PythonProgress(const CallOptions& options)
    : callback_(options.progress), cancel_(options.cancel) {
  if (!callback_.is_none() && PyCallable_Check(callback_.ptr()) == 0)
    throw py::type_error("progress is not callable");
}

PythonProgress::~PythonProgress() = default;

void PythonProgress::begin_stage(std::string_view name) {
  stage_ = printable(name);
  fraction_ = 0.0;
  sent_percent_ = 0;
  send(std::nullopt);
}

void PythonProgress::report(double fraction) {
  fraction_ = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
  const int percent = int(fraction_ * 100.0);
  if (percent == sent_percent_) return;
  sent_percent_ = percent;
  send(std::nullopt);
}

void PythonProgress::note(std::string_view sentence) {
  const std::string text = printable(sentence);
  if (text.starts_with(kWarning)) warnings_.push_back(text.substr(kWarning.size()));
  send(text);
}

void PythonProgress::send(const std::optional<std::string>& note) {
  if (callback_.is_none() || stop_ || is_too_late()) return;
  const py::gil_scoped_acquire acquired;
  try {
    callback_(ProgressReport{stage_, fraction_, note});
  } catch (py::error_already_set& error) {
    exception_ = std::make_unique<py::error_already_set>(std::move(error));
    stop_ = true;
  }
}

bool PythonProgress::stop_requested() const {
  if (stop_ || is_too_late() || (cancel_ && cancel_->is_cancelled())) return true;
  if (std::this_thread::get_id() != caller_) return false;
  check_signals();
  return stop_;
}

void PythonProgress::check_signals() const {
  const auto now = std::chrono::steady_clock::now();
  if (now - checked_ < kSignalInterval) return;
  checked_ = now;
  const py::gil_scoped_acquire acquired;
  if (PyErr_CheckSignals() == 0) return;
  exception_ = std::make_unique<py::error_already_set>();  // Takes the exception of the handler.
  stop_ = true;
}

void PythonProgress::raise_exception() {
  if (!exception_) return;
  py::error_already_set exception = std::move(*exception_);
  exception_.reset();
  throw exception;
}

void bind_call(py::module_& module) {
  py::class_<ProgressReport>(module, "Progress", doc("Progress"))
      .def_readonly("stage", &ProgressReport::stage, doc("Progress::begin_stage"))
      .def_readonly("fraction", &ProgressReport::fraction, doc("Progress::report"))
      .def_readonly("note", &ProgressReport::note, doc("Progress::note"))
      .def("__repr__", &describe);
  py::class_<CancelToken, std::shared_ptr<CancelToken>>(
      module, "CancelToken",
      "Stops a long function from another thread or from its progress callback. The function then\n"
      "raises Cancelled.")
      .def(py::init<>())
      .def("cancel", &CancelToken::cancel, "Requests a stop. It cannot be taken back.")
      .def_property_readonly("cancelled", &CancelToken::is_cancelled,
                             "Whether a stop was requested.")
      .def("__repr__", [](const CancelToken& token) {
        return token.is_cancelled() ? "<lefort.CancelToken: cancelled>" : "<lefort.CancelToken>";
      });
  module.def("_shut_down", &shut_down, "Ends calls and readers of files at the end of Python.");
  py::module_::import("atexit").attr("register")(module.attr("_shut_down"));
}

}  // namespace lefort::python
