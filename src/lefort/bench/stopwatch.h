/// \file
/// Time and memory of a piece of work.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace lefort::bench {

/// Wall-clock seconds since some moment.
[[nodiscard]] double now_seconds();

/// Runs from when it is made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return now_seconds() - begin_; }

  /// Seconds since the last lap or the beginning; begins the next.
  double lap() {
    const double last = std::exchange(lap_, now_seconds());
    return lap_ - last;
  }

 private:
  double begin_ = now_seconds();
  double lap_ = begin_;
};

/// Seconds of processor time of all threads of this process, the system's work for it included.
[[nodiscard]] double processor_seconds();

/// Memory this process holds now, and the most it held since reset_peak_memory() [bytes].
[[nodiscard]] std::size_t resident_bytes();
[[nodiscard]] std::size_t peak_resident_bytes();
void reset_peak_memory();

/// \pre not empty.
[[nodiscard]] double median(std::vector<double> values);

}  // namespace lefort::bench
