#include <lefort/core/check.h>
#include <lefort/verify/judge_refinement.h>
#include <lefort/verify/refinement.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::verify {

void judge_refinement(const std::string& name, std::span<const double> values, const Known& known,
                      Section& section) {
  LEFORT_CHECK(values.size() >= 3);
  const auto last = values.last<3>();
  const Refinement found = refinement_of({last[0], last[1], last[2]}, known.order);
  if (std::isnan(found.order) && !std::isnan(found.error)) {
    const auto [low, high] = std::ranges::minmax(last);
    section.checks.push_back({.name = fmt::format("{}: spread of the last three meshes", name),
                              .measured = (high - low) / std::abs(known.value),
                              .asked = Asked::kAtMost,
                              .tolerance = 0.01,
                              .reason = "the values go to and fro and have no order, so that they "
                                        "must have arrived"});
  } else {
    section.checks.push_back({.name = fmt::format("{}: order", name),
                              .measured = found.order,
                              .asked = Asked::kAtLeast,
                              .expected = known.order,
                              .tolerance = known.order_slack,
                              .reason = known.order_reason,
                              .miss = known.miss});
  }
  const std::string predicted = "the error that the last three meshes predict, times Roache's 1.25";
  section.checks.push_back(
      {.name = fmt::format("{}: difference over the predicted one", name),
       .measured = std::abs(last[2] - known.value) / (found.error + known.allowance),
       .asked = Asked::kAtMost,
       .expected = 1.0,
       .reason = known.allowance_reason.empty()
                     ? predicted
                     : fmt::format("{}; besides {:.2g}, as {}", predicted, known.allowance,
                                   known.allowance_reason),
       .miss = known.miss});
}

}  // namespace lefort::verify
