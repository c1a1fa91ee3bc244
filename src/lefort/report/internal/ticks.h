/// \file
/// Round numbers for axes and bars.
#pragma once

#include <string>
#include <vector>

namespace lefort::report {

/// \param limit  finite and > 0.
/// \returns the largest of 1, 2, 5 times a power of ten that is not above `limit`.
[[nodiscard]] double round_below(double limit);

/// \param low, high  finite, low < high.
/// \param wanted     >= 2.
/// \returns about `wanted` evenly spaced round numbers in [low, high], ascending.
[[nodiscard]] std::vector<double> ticks(double low, double high, int wanted);

/// \returns the text of a tick, up to six significant digits: "0", "2.5", "-10", "1e-07".
[[nodiscard]] std::string tick_text(double tick);

}  // namespace lefort::report
