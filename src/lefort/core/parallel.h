/// \file
/// Parallel loops whose results do not depend on the number of threads.
///
/// The range is divided into blocks of fixed size, and results of blocks are merged in block order.
/// So sums and lists have the same bits with 1 and with N threads. Only core uses TBB.
#pragma once

#include <lefort/core/check.h>
#ifdef __SANITIZE_THREAD__
#include <lefort/core/thread_loop.h>
#endif
#include <lefort/core/types.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace lefort {

/// Iterations per block. This number affects results: sums are computed block by block.
inline constexpr Index kParallelBlock = 256;

/// While it exists, limits the threads of every parallel loop of the process. Of several limits the
/// smallest one applies.
class ThreadLimit {
 public:
  /// \param threads  >= 0; 0: no limit.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

  /// \returns the maximum number of threads of a loop that starts now.
  [[nodiscard]] static int current();

 private:
  void* control_;
};

/// Calls body(begin, end) for consecutive blocks of [0, count). Blocks run in any order and must
/// not write to the same data.
///
/// \param block  iterations per block, > 0.
/// \throws what a body throws.
template <class Body>
void parallel_for_blocks(Index count, const Body& body, Index block = kParallelBlock) {
  LEFORT_CHECK(count >= 0 && block > 0);
  const Index blocks = (count + block - 1) / block;
  if (blocks == 0) return;
  const auto do_block = [&](Index b) { body(b * block, std::min(count, (b + 1) * block)); };
#ifdef __SANITIZE_THREAD__
  thread_loop(blocks, ThreadLimit::current(), do_block);
#else
  tbb::parallel_for(tbb::blocked_range<Index>(0, blocks, 1), [&](const auto& range) {
    for (Index b = range.begin(); b < range.end(); ++b) do_block(b);
  });
#endif
}

/// Calls body(i) for every i in [0, count), in any order; as parallel_for_blocks().
template <class Body>
void parallel_for(Index count, const Body& body, Index block = kParallelBlock) {
  parallel_for_blocks(
      count,
      [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) body(i);
      },
      block);
}

/// Sums term(i) over [0, count) in an order that depends on count only.
///
/// \param zero  the sum of no terms.
/// \returns the sum.
template <class Value, class Term>
[[nodiscard]] Value deterministic_sum(Index count, const Value& zero, const Term& term) {
  std::vector<Value> partial(std::size_t((count + kParallelBlock - 1) / kParallelBlock), zero);
  parallel_for_blocks(count, [&](Index begin, Index end) {
    Value& sum = partial[std::size_t(begin / kParallelBlock)];
    for (Index i = begin; i < end; ++i) sum += term(i);
  });
  Value total = zero;
  for (const Value& sum : partial) total += sum;
  return total;
}

/// Calls body(i, list) for every i in [0, count); the body appends items to the list.
///
/// \returns the items of all lists, in the order of i.
template <class Item, class Body>
[[nodiscard]] std::vector<Item> parallel_collect(Index count, const Body& body) {
  std::vector<std::vector<Item>> lists(std::size_t((count + kParallelBlock - 1) / kParallelBlock));
  parallel_for_blocks(count, [&](Index begin, Index end) {
    std::vector<Item>& list = lists[std::size_t(begin / kParallelBlock)];
    for (Index i = begin; i < end; ++i) body(i, list);
  });
  std::vector<Item> all;
  for (std::vector<Item>& list : lists)
    std::move(list.begin(), list.end(), std::back_inserter(all));
  return all;
}

}  // namespace lefort
