/// \file
/// Runs two independent tasks at the same time.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/parallel.h>
#include <lefort/core/progress.h>

#include <atomic>
#include <future>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace lefort {

/// Progress of a task that runs beside another one: keeps its notes.
class SideProgress final : public Progress {
 public:
  explicit SideProgress(const Progress& shown) : shown_(shown) {}

  void note(std::string_view sentence) override { notes_.emplace_back(sentence); }
  [[nodiscard]] bool stop_requested() const override { return shown_.stop_requested(); }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  const Progress& shown_;
  std::vector<std::string> notes_;
};

/// Forwards everything; also stops with another task.
class StoppableProgress final : public Progress {
 public:
  StoppableProgress(Progress& shown, const std::atomic<bool>& stop) : shown_(shown), stop_(stop) {}

  void begin_stage(std::string_view name) override { shown_.begin_stage(name); }
  void report(double fraction) override { shown_.report(fraction); }
  void note(std::string_view sentence) override { shown_.note(sentence); }
  [[nodiscard]] bool stop_requested() const override { return stop_ || shown_.stop_requested(); }

 private:
  Progress& shown_;
  const std::atomic<bool>& stop_;
};

/// Runs side(Progress&) in another thread while shown(Progress&) runs in this one; one after the
/// other if only one thread is allowed. If `side` fails, `shown` is asked to stop. Results, errors
/// and notes do not depend on which ends first: notes of `side` follow those of `shown`.
///
/// \param side      the shorter task, returns a Result; its stages are not reported.
/// \param shown     returns a Result.
/// \param progress  of this thread.
/// \returns both values; or the error of `side`, or that of `shown`.
/// \throws what a task throws.
template <class Side, class Shown>
[[nodiscard]] auto run_concurrently(const Side& side, const Shown& shown, Progress& progress)
    -> Result<std::pair<typename std::invoke_result_t<Side, Progress&>::value_type,
                        typename std::invoke_result_t<Shown, Progress&>::value_type>> {
  std::atomic<bool> stop_shown = false;
  SideProgress quiet(progress);
  StoppableProgress here(progress, stop_shown);
  const bool is_single = ThreadLimit::current() == 1;
  auto beside = std::async(is_single ? std::launch::deferred : std::launch::async, [&] {
    auto result = side(quiet);
    stop_shown = !result;
    return result;
  });
  if (is_single) beside.wait();
  auto second = shown(here);
  auto first = beside.get();
  for (const std::string& sentence : quiet.notes()) progress.note(sentence);
  if (!first) return tl::unexpected(first.error());
  if (!second) return tl::unexpected(second.error());
  return std::pair(*std::move(first), *std::move(second));
}

}  // namespace lefort
