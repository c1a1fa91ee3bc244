#include <lefort/core/check.h>
#include <lefort/report/internal/ticks.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::report {

double round_below(double limit) {
  LEFORT_CHECK(std::isfinite(limit) && limit > 0.0);
  const double power = std::pow(10.0, std::floor(std::log10(limit) + 1e-9));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= limit * (1.0 + 1e-9)) return digit * power;
  return power;
}

std::vector<double> ticks(double low, double high, int wanted) {
  LEFORT_CHECK(low < high && wanted >= 2);
  const double step = round_below(3.0 * (0.5 * high - 0.5 * low) / double(wanted));
  std::vector<double> found;
  const double first = std::ceil(low / step - 1e-9);
  const double last = std::floor(high / step + 1e-9);
  for (double n = first; n <= last && found.size() < 50; n += 1.0)
    found.push_back(n * step == 0.0 ? 0.0 : n * step);  // No negative zero.
  return found;
}

std::string tick_text(double tick) { return fmt::format("{:.6g}", tick); }

}  // namespace lefort::report
