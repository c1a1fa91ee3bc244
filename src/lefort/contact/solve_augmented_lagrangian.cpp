#include <lefort/contact/solve_augmented_lagrangian.h>
#include <lefort/core/check.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace lefort::contact {
namespace {

/// The loop ends after this many updates in a row that do not reduce the depth below this fraction
/// of its minimum so far. A single update may fail to, because the P99 changes with the area in
/// contact. (Test EndsWhereUpdatesReduceNothing.)
constexpr int kMaxStalledUpdates = 3;
constexpr double kMaxDepthRatio = 0.99;

/// Max over the contacts of the P99 of the depth, as a multiple of the tolerance; 0 if there is
/// none.
double excess_depth(std::span<const ContactTerm> contacts, std::span<const Vec3> x_L) {
  double max_excess = 0.0;
  for (const ContactTerm& contact : contacts)
    if (const auto tolerance_mm = contact.penetration_tolerance_mm())
      max_excess =
          std::max(max_excess, contact.summarize(x_L).p99_penetration_increase_mm / *tolerance_mm);
  return max_excess;
}

/// Steps 3 and 4 of the algorithm, for one state after the other.
class MultiplierUpdate {
 public:
  enum class Result { kDone, kStalled, kChanged };

  Result apply(std::span<ContactTerm> contacts, std::span<const Vec3> x_L) {
    const double excess = excess_depth(contacts, x_L);
    if (excess > 1.0)
      for (ContactTerm& contact : contacts)
        if (contact.penetration_tolerance_mm()) contact.update_multipliers(x_L);
    Index activated = 0;
    for (ContactTerm& contact : contacts) activated += contact.activate_tangent_planes(x_L);
    if (activated == 0 && excess <= 1.0) return Result::kDone;
    const bool is_progress = activated > 0 || excess < kMaxDepthRatio * min_excess_;
    stalled_ = is_progress ? 0 : stalled_ + 1;
    min_excess_ = std::min(min_excess_, excess);
    return stalled_ == kMaxStalledUpdates ? Result::kStalled : Result::kChanged;
  }

 private:
  double min_excess_ = std::numeric_limits<double>::infinity();
  int stalled_ = 0;
};

void commit(std::span<ContactTerm> contacts, std::span<const Vec3> x_L) {
  for (ContactTerm& contact : contacts) contact.commit(x_L);
}

void roll_back(std::span<ContactTerm> contacts) {
  for (ContactTerm& contact : contacts) contact.rollback();
}

/// \returns the reason of the first contact that rejects the state.
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
  commit(contacts, x_L);

  MultiplierUpdate update;
  for (int n = 0; n < kMaxMultiplierUpdates; ++n) {
    const auto updated = update.apply(contacts, x_L);
    if (updated == MultiplierUpdate::Result::kDone) break;
    if (updated == MultiplierUpdate::Result::kStalled) {
      // No equilibrium was computed with the last update.
      roll_back(contacts);
      break;
    }
    fem::NewtonOutcome next = solve(outcome.x);
    if (next.stop == fem::NewtonStop::kCancelled || next.stop == fem::NewtonStop::kOutOfMemory)
      return next;
    if (next.converged()) x_L = displaced(nodes_L, next.x);
    if (!next.converged() || rejection_reason(contacts, x_L)) {
      roll_back(contacts);
      const fem::NewtonIterate last = outcome.history.back();
      append(next, outcome.history);
      outcome.history.push_back(last);
      break;
    }
    commit(contacts, x_L);
    append(next, outcome.history);
    next.history = std::move(outcome.history);
    outcome = std::move(next);
  }
  return outcome;
}

}  // namespace lefort::contact
