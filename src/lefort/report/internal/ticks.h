/// \file
/// Round numbers for axes and bars.
#pragma once

#include <string>
#include <vector>

namespace lefort::report {

/// The largest of 1, 2, 5 times a power of ten that is not above `limit`.
/// \pre limit is finite and > 0
[[nodiscard]] double round_below(double limit);

/// Evenly spaced round numbers in [low, high], about `wanted` of them, ascending.
/// \pre low < high, both finite; wanted >= 2
[[nodiscard]] std::vector<double> ticks(double low, double high, int wanted);

/// A tick as short as it can be said: "0", "2.5", "-10", "1e-7".
[[nodiscard]] std::string tick_text(double tick);

}  // namespace lefort::report
