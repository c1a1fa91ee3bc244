/// \file
/// Record of how long named pieces of work take, for a profile of the program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lefort {

/// A piece of work of one thread.
struct TraceEvent {
  std::string name;
  double begin_us = 0.0;     ///< Since start_trace().
  double duration_us = 0.0;  ///< Wall-clock time.
  std::uint32_t thread = 0;  ///< 0: the thread that started the trace.
};

/// Begins the record. One record at a time in a process.
void start_trace();

/// Ends the record.
/// \returns the events, in order of their end; empty if no record was begun.
[[nodiscard]] std::vector<TraceEvent> stop_trace();

/// Records the time from its construction to its destruction, if there is a record; otherwise it
/// costs one load. A span that outlives its record is dropped. For work of more than about 0.1 ms:
/// at most a million events are kept.
class TraceSpan {
 public:
  /// \param name  a literal.
  explicit TraceSpan(const char* name);
  ~TraceSpan();
  TraceSpan(const TraceSpan&) = delete;
  TraceSpan& operator=(const TraceSpan&) = delete;

 private:
  const char* name_;  ///< Null without a record.
  std::int64_t begin_ns_ = 0;
  std::uint32_t record_ = 0;  ///< In which it began.
};

/// Records an event of this thread that began at `begin_us`, for names that are not literals.
void record_event(std::string name, double begin_us);

/// \returns the time since start_trace() [us]; 0 without a record.
[[nodiscard]] double trace_time_us();

}  // namespace lefort
