#include <lefort/contact/contact_surface.h>
#include <lefort/contact/solve_active_set.h>

#include <algorithm>
#include <utility>

namespace lefort::contact {
namespace {

/// Appends the history of a solve, without its start unless it is the first.
void append(std::vector<fem::NewtonIterate>& history, const fem::NewtonOutcome& next) {
  const std::size_t skipped = history.empty() || next.history.empty() ? 0 : 1;
  history.insert(history.end(), next.history.begin() + std::ptrdiff_t(skipped), next.history.end());
}

bool is_final(fem::NewtonStop stop) {
  return stop == fem::NewtonStop::kCancelled || stop == fem::NewtonStop::kOutOfMemory;
}

}  // namespace

fem::NewtonOutcome solve_active_set(std::span<WeightedContactTerm* const> contacts,
                                    std::span<const Vec3> nodes_L, std::vector<ActiveSet> active,
                                    const VectorX& start, int max_iterations,
                                    const SolveFrom& solve) {
  VectorX at = start;
  std::vector<fem::NewtonIterate> history;
  const auto release = [&] {
    for (WeightedContactTerm* contact : contacts) contact->set_active({});
  };
  for (int n = 0; n < kMaxActiveSetSteps; ++n) {
    const std::vector<Vec3> from_L = displaced(nodes_L, at);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      contacts[k]->note_clearances(from_L);
      contacts[k]->set_active(active[k]);
    }
    fem::NewtonOutcome next = solve(at, 1);
    append(history, next);
    if (is_final(next.stop)) {
      release();
      next.history = std::move(history);
      return next;
    }
    const bool is_step = next.iterations() == 1 && next.history.back().step_length > 0.0;
    if (!next.converged() && !is_step) break;
    const std::vector<Vec3> to_L = displaced(nodes_L, next.x);
    const double length = is_step ? next.history.back().step_length : 1.0;
    bool is_same = true;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      ActiveSet updated = contacts[k]->updated_active_set(active[k], from_L, to_L, length);
      is_same = is_same && same_active_patches(updated, active[k]);
      active[k] = std::move(updated);
    }
    at = std::move(next.x);
    if (next.converged() && is_same) break;
  }
  release();
  for (WeightedContactTerm* contact : contacts) contact->note_clearances(displaced(nodes_L, at));
  fem::NewtonOutcome end = solve(at, max_iterations);
  append(history, end);
  end.history = std::move(history);
  return end;
}

}  // namespace lefort::contact
