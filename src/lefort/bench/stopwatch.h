/// \file
/// Time and memory of this process.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace lefort::bench {

/// Wall-clock seconds since an unspecified time.
[[nodiscard]] double now_seconds();

/// Measures wall-clock time from its construction.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return now_seconds() - begin_; }

  /// Seconds since the last lap or the beginning; starts the next lap.
  double lap() {
    const double last = std::exchange(lap_, now_seconds());
    return lap_ - last;
  }

 private:
  double begin_ = now_seconds();
  double lap_ = begin_;
};

/// Processor time of all threads of this process, including system time [s].
[[nodiscard]] double processor_seconds();

/// Current resident memory, and its maximum since reset_peak_memory() [bytes]. The maximum is not
/// that of getrusage() (pipeline/timing/peak_memory.h), which cannot be reset.
[[nodiscard]] std::size_t resident_bytes();
[[nodiscard]] std::size_t peak_resident_bytes();
void reset_peak_memory();

/// Median. \pre not empty.
[[nodiscard]] double median(std::vector<double> values);

}  // namespace lefort::bench
