#include <lefort/compare/agreement.h>
#include <lefort/core/check.h>

#include <cmath>
#include <limits>
#include <vector>

namespace lefort::compare {

Agreement agreement_of(std::span<const double> first, std::span<const double> second) {
  LEFORT_CHECK(first.size() == second.size());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kNormal = 1.96;  // Half width of the central 95 % of a normal distribution.
  std::vector<double> differences;
  double sum = 0.0;
  for (std::size_t k = 0; k < first.size(); ++k) {
    const double difference = first[k] - second[k];
    if (std::isnan(difference)) continue;
    differences.push_back(difference);
    sum += difference;
  }
  Agreement agreement{Index(differences.size()), kNone, kNone, {kNone, kNone}};
  if (differences.empty()) return agreement;
  agreement.bias = sum / double(differences.size());
  if (differences.size() < 2) return agreement;
  double squares = 0.0;
  for (const double d : differences) squares += (d - agreement.bias) * (d - agreement.bias);
  agreement.standard_deviation = std::sqrt(squares / double(differences.size() - 1));
  const double half_width = kNormal * agreement.standard_deviation;
  agreement.limits = {agreement.bias - half_width, agreement.bias + half_width};
  return agreement;
}

}  // namespace lefort::compare
