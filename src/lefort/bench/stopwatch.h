/// \file
/// Time and memory of a piece of work.
#pragma once

#include <cstddef>
#include <vector>

namespace lefort::bench {

/// Wall-clock seconds since some moment.
[[nodiscard]] double now_seconds();

/// Seconds of processor time of all threads of this process, in user mode.
[[nodiscard]] double user_seconds();

/// Memory this process holds now, and the most it held since reset_peak_memory() [bytes].
[[nodiscard]] std::size_t resident_bytes();
[[nodiscard]] std::size_t peak_resident_bytes();
void reset_peak_memory();

/// \pre not empty.
[[nodiscard]] double median(std::vector<double> values);

}  // namespace lefort::bench
