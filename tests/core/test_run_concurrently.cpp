#include <lefort/core/run_concurrently.h>

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace lefort::test_run_concurrently {
namespace {

struct Notes final : Progress {
  std::vector<std::string> all;
  void note(std::string_view sentence) override { all.emplace_back(sentence); }
};

TEST(RunConcurrently, ReturnsBothValuesAndNotesInAFixedOrder) {
  for (const int threads : {0, 1}) {
    const ThreadLimit limit(threads);
    Notes notes;
    const auto both = run_concurrently(
        [](Progress& progress) -> Result<int> {
          progress.note("side");
          return 1;
        },
        [](Progress& progress) -> Result<std::unique_ptr<int>> {
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
          progress.note("shown");
          return std::make_unique<int>(2);
        },
        notes);
    ASSERT_TRUE(both);
    EXPECT_EQ(both->first, 1);
    EXPECT_EQ(*both->second, 2);
    EXPECT_EQ(notes.all, (std::vector<std::string>{"shown", "side"}));
  }
}

TEST(RunConcurrently, AFailureOfTheSideStopsTheOther) {
  Notes notes;
  const auto both = run_concurrently(
      [](Progress&) -> Result<int> { return fail(ErrorCode::kPlanInvalid, "too far"); },
      [](Progress& progress) -> Result<int> {
        while (!progress.stop_requested())
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return fail(ErrorCode::kCancelled, "cancelled");
      },
      notes);
  ASSERT_FALSE(both);
  EXPECT_EQ(both.error().message, "too far");
}

TEST(RunConcurrently, TheErrorOfTheSideComesFirst) {
  const auto fails = [](const char* why) {
    return [why](Progress&) -> Result<int> { return fail(ErrorCode::kMeshInvalid, why); };
  };
  Notes notes;
  const auto both = run_concurrently(fails("side"), fails("shown"), notes);
  ASSERT_FALSE(both);
  EXPECT_EQ(both.error().message, "side");
  const auto good = [](Progress&) -> Result<int> { return 1; };
  const auto second = run_concurrently(good, fails("shown"), notes);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().message, "shown");
}

TEST(RunConcurrently, ThrowsWhatATaskThrows) {
  Notes notes;
  const auto throws = [](Progress&) -> Result<int> { throw std::runtime_error("no"); };
  const auto good = [](Progress&) -> Result<int> { return 1; };
  EXPECT_THROW((void)run_concurrently(throws, good, notes), std::runtime_error);
  EXPECT_THROW((void)run_concurrently(good, throws, notes), std::runtime_error);
}

}  // namespace
}  // namespace lefort::test_run_concurrently
