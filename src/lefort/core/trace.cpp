#include <lefort/core/trace.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

namespace lefort {
namespace {

constexpr std::size_t kMaxEvents = 1'000'000;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// The record of this process.
struct Record {
  std::atomic<bool> is_on = false;
  std::atomic<std::int64_t> begin_ns = 0;
  std::mutex mutex;  ///< Of the members below.
  std::vector<TraceEvent> events;
  std::uint32_t threads = 0;
  std::atomic<std::uint32_t> generation = 0;
};

Record& record() {
  static Record the_record;
  return the_record;
}

/// Number of this thread in the present record. \pre The mutex is held.
std::uint32_t thread_number(Record& all) {
  thread_local std::uint32_t number = 0, generation = 0;
  if (generation != all.generation) {
    generation = all.generation;
    number = all.threads++;
  }
  return number;
}

void add(std::string name, std::uint32_t generation, std::int64_t begin_ns, std::int64_t end_ns) {
  Record& all = record();
  const std::scoped_lock lock(all.mutex);
  if (!all.is_on || generation != all.generation || all.events.size() >= kMaxEvents) return;
  all.events.push_back({std::move(name), double(begin_ns - all.begin_ns) * 1e-3,
                        double(end_ns - begin_ns) * 1e-3, thread_number(all)});
}

}  // namespace

void start_trace() {
  Record& all = record();
  const std::scoped_lock lock(all.mutex);
  all.events.clear();
  all.threads = 0;
  ++all.generation;
  all.begin_ns = now_ns();
  thread_number(all);
  all.is_on = true;
}

std::vector<TraceEvent> stop_trace() {
  Record& all = record();
  const std::scoped_lock lock(all.mutex);
  all.is_on = false;
  return std::exchange(all.events, {});
}

TraceSpan::TraceSpan(const char* name)
    : name_(record().is_on.load(std::memory_order_relaxed) ? name : nullptr) {
  if (name_ == nullptr) return;
  record_ = record().generation;
  begin_ns_ = now_ns();
}

TraceSpan::~TraceSpan() {
  if (name_ != nullptr) add(name_, record_, begin_ns_, now_ns());
}

void record_event(std::string name, double begin_us) {
  if (!record().is_on) return;
  add(std::move(name), record().generation, record().begin_ns + std::int64_t(begin_us * 1e3),
      now_ns());
}

double trace_time_us() {
  return record().is_on ? double(now_ns() - record().begin_ns) * 1e-3 : 0.0;
}

}  // namespace lefort
