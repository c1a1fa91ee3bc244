#include <lefort/core/check.h>
#include <lefort/verify/check_convergence_order.h>
#include <lefort/verify/refinement.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::verify {
namespace {

/// \param predicted  error of the last value.
void add_difference(const std::string& name, double last, double predicted, const Known& known,
                    Section& section) {
  const std::string reason = "the error that the last three meshes predict, times Roache's 1.25";
  section.checks.push_back(
      {.name = fmt::format("{}: difference over the predicted one", name),
       .measured = std::abs(last - known.value) / (predicted + known.allowance),
       .comparison = Comparison::kAtMost,
       .expected = 1.0,
       .reason = known.allowance_reason.empty()
                     ? reason
                     : fmt::format("{}, plus {:.2g}, as {}", reason, known.allowance,
                                   known.allowance_reason),
       .known_failure = known.known_failure});
}

}  // namespace

void check_convergence_order(const std::string& name, std::span<const double> values,
                             const Known& known, Section& section) {
  LEFORT_CHECK(values.size() >= 3);
  const auto last = values.last<3>();
  const Refinement found = refinement_of({last[0], last[1], last[2]}, known.order);
  if (std::isnan(found.order) && !std::isnan(found.error)) {
    const auto [low, high] = std::ranges::minmax(last);
    section.checks.push_back(
        {.name = fmt::format("{}: spread of the last three meshes", name),
         .measured = (high - low) / std::abs(known.value),
         .comparison = Comparison::kAtMost,
         .tolerance = 0.01,
         .reason = "the values alternate and have no order, so that they must have converged"});
  } else {
    section.checks.push_back({.name = fmt::format("{}: order", name),
                              .measured = found.order,
                              .comparison = Comparison::kAtLeast,
                              .expected = known.order,
                              .tolerance = known.order_slack,
                              .reason = known.order_reason,
                              .known_failure = known.known_failure});
  }
  add_difference(name, last[2], found.error, known, section);
}

void check_difference(const std::string& name, const std::array<double, 3>& values,
                      double norm_order, const Known& known, Section& section) {
  const double order = std::min(norm_order, known.order);
  add_difference(name, values[2], predicted_error(values, order), known, section);
}

void check_error_order(const std::string& name, std::span<const double> errors, const Known& known,
                       Section& section) {
  LEFORT_CHECK(errors.size() >= 2);
  const auto order_to = [&](std::size_t k) { return std::log2(errors[k - 1] / errors[k]); };
  const std::size_t last = errors.size() - 1;
  section.checks.push_back({.name = fmt::format("{}: order of the error", name),
                            .measured = order_to(last),
                            .comparison = Comparison::kAtLeast,
                            .expected = known.order,
                            .tolerance = known.order_slack,
                            .reason = known.order_reason,
                            .known_failure = known.known_failure});
  if (last < 2) return;
  const double fall = std::exp2(std::min(order_to(last - 1), known.order));
  section.checks.push_back(
      {.name = fmt::format("{}: error over the predicted one", name),
       .measured = errors[last] * fall / (kRefinementSafety * errors[last - 1]),
       .comparison = Comparison::kAtMost,
       .expected = 1.0,
       .reason =
           "the error that the two meshes before and their order predict, times Roache's 1.25"});
}

}  // namespace lefort::verify
