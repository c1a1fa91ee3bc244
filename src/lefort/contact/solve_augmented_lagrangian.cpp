#include <lefort/contact/solve_augmented_lagrangian.h>
#include <lefort/core/check.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace lefort::contact {
namespace {

/// Augmenting is given up when so many in a row have not lowered the depth below this part of the
/// least so far. One alone may well not: as the area in contact changes, so does its P99.
constexpr int kEvictionTimeout = 3;
constexpr double kGain = 0.99;

/// How much deeper tissue lies than it may, as a ratio, in the worst contact; 0 if none is asked.
double excess(std::span<const ContactTerm> contacts, std::span<const Vec3> x_L) {
  double worst = 0.0;
  for (const ContactTerm& contact : contacts)
    if (const auto tolerance_mm = contact.penetration_tolerance_mm())
      worst = std::max(worst, contact.summarize(x_L).p99_depth_from_rest_mm / *tolerance_mm);
  return worst;
}

std::optional<std::string> rejection_reason(std::span<const ContactTerm> contacts,
                                            std::span<const Vec3> x_L) {
  for (const ContactTerm& contact : contacts)
    if (auto why = contact.rejection_reason(x_L)) return why;
  return std::nullopt;
}

/// Appends the history of a solve, without its start.
void append(const fem::NewtonOutcome& from, std::vector<fem::NewtonIterate>& history) {
  if (!from.history.empty())
    history.insert(history.end(), from.history.begin() + 1, from.history.end());
}

}  // namespace

std::vector<Vec3> displaced(std::span<const Vec3> nodes_L, const VectorX& u) {
  LEFORT_CHECK(u.size() == 3 * Index(nodes_L.size()));
  std::vector<Vec3> x_L(nodes_L.begin(), nodes_L.end());
  for (std::size_t n = 0; n < x_L.size(); ++n) x_L[n] += u.segment<3>(3 * Index(n));
  return x_L;
}

fem::NewtonOutcome solve_augmented_lagrangian(
    std::span<ContactTerm> contacts, std::span<const Vec3> nodes_L, const VectorX& start,
    const std::function<fem::NewtonOutcome(const VectorX& start)>& solve) {
  for (ContactTerm& contact : contacts) contact.begin_step();
  fem::NewtonOutcome outcome = solve(start);
  if (!outcome.converged()) return outcome;
  std::vector<Vec3> x_L = displaced(nodes_L, outcome.x);
  if (auto why = rejection_reason(contacts, x_L)) {
    outcome.stop = fem::NewtonStop::kRejected;
    outcome.reason = *std::move(why);
    return outcome;
  }
  for (ContactTerm& contact : contacts) contact.commit(x_L);

  double min_excess = std::numeric_limits<double>::infinity();
  int idle = 0;
  for (int n = 0; n < kMaxMultiplierUpdates; ++n) {
    const double now = excess(contacts, x_L);
    if (now > 1.0)
      for (ContactTerm& contact : contacts)
        if (contact.penetration_tolerance_mm()) contact.update_multipliers(x_L);
    Index crossed = 0;
    for (ContactTerm& contact : contacts) crossed += contact.activate_tangent_planes(x_L);
    if (crossed == 0 && now <= 1.0) break;
    idle = crossed > 0 || now < kGain * min_excess ? 0 : idle + 1;
    if (idle == kEvictionTimeout) {
      // Nothing was solved with what was added last: what is told must be in balance.
      for (ContactTerm& contact : contacts) contact.rollback();
      break;
    }
    min_excess = std::min(min_excess, now);
    fem::NewtonOutcome next = solve(outcome.x);
    if (next.stop == fem::NewtonStop::kCancelled || next.stop == fem::NewtonStop::kOutOfMemory)
      return next;
    if (next.converged()) x_L = displaced(nodes_L, next.x);
    if (!next.converged() || rejection_reason(contacts, x_L)) {
      for (ContactTerm& contact : contacts) contact.rollback();
      const fem::NewtonIterate kept = outcome.history.back();
      append(next, outcome.history);
      outcome.history.push_back(kept);
      break;
    }
    for (ContactTerm& contact : contacts) contact.commit(x_L);
    append(next, outcome.history);
    next.history = std::move(outcome.history);
    outcome = std::move(next);
  }
  return outcome;
}

}  // namespace lefort::contact
