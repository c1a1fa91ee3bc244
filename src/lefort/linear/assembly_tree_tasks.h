/// \file
/// Parallel traversal of the supernodes of a plan, with one task per small subtree (\cite
/// duff1983).
#pragma once

#include <lefort/core/isolate.h>
#include <lefort/core/parallel.h>
#include <lefort/linear/cholesky_plan.h>

#include <cstdint>
#include <utility>

namespace lefort::linear {

/// Whether the loops within a front run in parallel; this is useful only near the root.
enum class FrontLoops { kSerial, kParallel };

/// A subtree with at most this fraction of the total work is one task.
inline constexpr double kTaskFraction = 1.0 / 64;

/// Calls visit(supernode, loops) for all supernodes, children before their parent.
template <class Visit>
void visit_upwards(const CholeskyPlan& plan, const Visit& visit) {
  const double small = kTaskFraction * plan.work();
  const auto subtree = [&](const auto& self, std::int32_t s) -> void {
    const Supernode& node = plan.supernodes[std::size_t(s)];
    if (node.work <= small) {
      for (std::int32_t t = node.first_descendant; t <= s; ++t) visit(t, FrontLoops::kSerial);
      return;
    }
    const auto children = plan.children_of(s);
    parallel_for(
        Index(children.size()), [&](Index c) { self(self, children[std::size_t(c)]); }, 1);
    visit(s, FrontLoops::kParallel);
  };
  const auto roots = plan.roots();
  parallel_for(
      Index(roots.size()), [&](Index r) { subtree(subtree, roots[std::size_t(r)]); }, 1);
}

/// Calls visit(supernode, loops) for all supernodes, parents before their children.
template <class Visit>
void visit_downwards(const CholeskyPlan& plan, const Visit& visit) {
  const double small = kTaskFraction * plan.work();
  const auto subtree = [&](const auto& self, std::int32_t s) -> void {
    const Supernode& node = plan.supernodes[std::size_t(s)];
    if (node.work <= small) {
      for (std::int32_t t = s; t >= node.first_descendant; --t) visit(t, FrontLoops::kSerial);
      return;
    }
    visit(s, FrontLoops::kParallel);
    const auto children = plan.children_of(s);
    parallel_for(
        Index(children.size()), [&](Index c) { self(self, children[std::size_t(c)]); }, 1);
  };
  const auto roots = plan.roots();
  parallel_for(
      Index(roots.size()), [&](Index r) { subtree(subtree, roots[std::size_t(r)]); }, 1);
}

/// Calls body(i) for every i in [0, count). While a thread waits here it does not start another
/// subtree, since that would delay this front.
///
/// \param loops  whether to run in parallel.
/// \param count  number of iterations.
/// \param body   called concurrently.
/// \param block  iterations per task.
template <class Body>
void loop_in_front(FrontLoops loops, Index count, const Body& body, Index block = 1) {
  if (loops == FrontLoops::kSerial || count <= block) {
    for (Index i = 0; i < count; ++i) body(i);
    return;
  }
  isolate([&] { parallel_for(count, body, block); });
}

}  // namespace lefort::linear
