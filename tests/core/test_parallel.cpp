#include <lefort/core/error.h>
#include <lefort/core/parallel.h>
#include <lefort/core/thread_loop.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace lefort::test_parallel {
namespace {

constexpr Index kCount = 100'003;  // Not a multiple of the block.

double awkward_term(Index i) { return std::sin(double(i)) * std::pow(10.0, double(i % 17) - 8.0); }

TEST(Parallel, SumHasTheSameBitsForAnyNumberOfThreads) {
  const auto sum_with = [](int threads) {
    const ThreadLimit limit(threads);
    return deterministic_sum(kCount, 0.0, awkward_term);
  };
  const double one = sum_with(1);
  EXPECT_EQ(one, sum_with(2));
  EXPECT_EQ(one, sum_with(7));
}

TEST(Parallel, CollectKeepsTheOrderOfTheIndices) {
  const auto multiples = parallel_collect<Index>(kCount, [](Index i, auto& list) {
    if (i % 3 == 0) list.push_back(i);
  });
  ASSERT_EQ(Index(multiples.size()), (kCount + 2) / 3);
  for (std::size_t n = 0; n < multiples.size(); ++n) EXPECT_EQ(multiples[n], Index(3 * n));
}

TEST(Parallel, ForVisitsEveryIndexOnce) {
  std::vector<int> visits(std::size_t(kCount), 0);
  parallel_for(kCount, [&](Index i) { ++visits[std::size_t(i)]; });
  EXPECT_EQ(std::accumulate(visits.begin(), visits.end(), Index(0)), kCount);
  EXPECT_EQ(*std::max_element(visits.begin(), visits.end()), 1);
}

TEST(ThreadLoop, CallsEveryIndexOnceInNestedLoops) {
  constexpr Index kOuter = 5, kMiddle = 3, kInner = 4;
  std::vector<int> calls(std::size_t(kOuter * kMiddle * kInner), 0);
  thread_loop(kOuter, 3, [&](Index i) {
    thread_loop(kMiddle, 2, [&](Index j) {
      thread_loop(kInner, 2,
                  [&](Index k) { ++calls[std::size_t((i * kMiddle + j) * kInner + k)]; });
    });
  });
  EXPECT_EQ(calls, std::vector<int>(calls.size(), 1));
}

TEST(ThreadLoop, RunsOnSeveralThreadsButNotMoreThanTheLimit) {
  std::vector<std::thread::id> ids(100);
  thread_loop(Index(ids.size()), 3,
              [&](Index i) { ids[std::size_t(i)] = std::this_thread::get_id(); });
  EXPECT_EQ(std::set(ids.begin(), ids.end()).size(), 3);
}

TEST(ThreadLoop, RethrowsAnExceptionOfABody) {
  const auto throw_in = [](Index one) {
    thread_loop(8, 2, [one](Index i) {
      if (i == one) throw std::runtime_error("body");
    });
  };
  EXPECT_THROW(throw_in(0), std::runtime_error);
  EXPECT_THROW(throw_in(5), std::runtime_error);
  EXPECT_NO_THROW(throw_in(8));
}

TEST(Parallel, AnEmptyRangeIsAllowed) { EXPECT_EQ(deterministic_sum(0, 0.0, awkward_term), 0.0); }

Result<int> half_of(int number) {
  if (number % 2 != 0)
    return fail(ErrorCode::kInvalidArgument, "number is " + std::to_string(number) + ", not even");
  return number / 2;
}

Result<int> quarter_of(int number) {
  LEFORT_TRY(const int half, half_of(number));
  return half_of(half);
}

TEST(Error, TryReturnsTheFirstError) {
  EXPECT_EQ(quarter_of(12).value(), 3);
  EXPECT_EQ(quarter_of(6).error().message, "number is 3, not even");
  EXPECT_EQ(quarter_of(7).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::test_parallel
