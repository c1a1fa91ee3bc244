#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cache/stage_cache.h>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace lefort::pipeline::test_stage_cache {
namespace {

namespace fs = std::filesystem;

/// A stage that makes a text and counts how often it had to.
struct TextStage {
  StageCache cache;
  int made = 0;

  Result<std::string> get(const std::string& key, Progress& progress = Progress::none()) {
    return cache.get(
        "text.txt", key, progress, [](const fs::path& path) { return io::read_text(path, 100); },
        [&]() -> Result<std::string> {
          ++made;
          return "made for " + key;
        },
        [](const fs::path& path, const std::string& text) { return io::write_text(path, text); });
  }
};

const std::string kKey(64, 'a');
const std::string kOtherKey(64, 'b');

TEST(StageCache, MakesOnceAndReadsAfterwards) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.made, 1);
}

TEST(StageCache, KeepsTheFilesThatWereUsedLast) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  const auto key = [](int n) { return std::string(63, 'k').insert(0, 1, char('a' + n)); };
  const auto now = fs::file_time_type::clock::now();
  for (int n = 0; n < 8; ++n) {
    ASSERT_TRUE(stage.get(key(n)));
    fs::last_write_time(stage.cache.file("text.txt", key(n)), now - std::chrono::hours(9 - n));
  }
  ASSERT_TRUE(stage.get(key(0)));  // Used again: now key(1) is the oldest.
  ASSERT_EQ(stage.made, 8);
  ASSERT_TRUE(stage.get(key(8)));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "cache"), {}), 16);  // And digests.
  EXPECT_FALSE(fs::exists(stage.cache.file("text.txt", key(1))));
  ASSERT_TRUE(stage.get(key(0)));
  ASSERT_TRUE(stage.get(key(2)));
  EXPECT_EQ(stage.made, 9);
}

TEST(StageCache, OtherInputsAreRebuilt) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.get(kOtherKey).value(), "made for " + kOtherKey);
  EXPECT_EQ(stage.made, 2);
}

TEST(StageCache, ADamagedFileIsRebuilt) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  ASSERT_TRUE(stage.get(kKey));
  ASSERT_TRUE(io::write_text(stage.cache.file("text.txt", kKey), std::string(200, 'x')));
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.made, 2);
}

TEST(StageCache, AFileWithAWrongBitOrWithoutItsDigestIsRebuilt) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  ASSERT_TRUE(stage.get(kKey));
  const fs::path file = stage.cache.file("text.txt", kKey);
  std::string bytes = io::read_text(file, 100).value();
  bytes[4] ^= 1;  // Still a text: read() has no reason to reject it.
  ASSERT_TRUE(io::write_text(file, bytes));
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.made, 2);
  fs::remove(digest_file(file));
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.made, 3);
  ASSERT_TRUE(io::write_text(digest_file(file), "other text"));
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.made, 4);
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.made, 4);
}

/// Records stages and notes.
class RecordedProgress final : public Progress {
 public:
  void begin_stage(std::string_view name) override { stages += name; }
  void note(std::string_view sentence) override { notes += sentence; }
  std::string stages, notes;
};

TEST(StageCache, ReportsWhetherItReadOrComputed) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  RecordedProgress first, second;
  ASSERT_TRUE(stage.get(kKey, first));
  EXPECT_EQ(first.stages, "");
  ASSERT_TRUE(stage.get(kKey, second));
  EXPECT_EQ(second.stages, "read text.txt from the cache");
}

TEST(StageCache, ReportsADamagedFileInOneLineWithoutItsFolder) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  ASSERT_TRUE(stage.get(kKey));
  ASSERT_TRUE(io::write_text(stage.cache.file("text.txt", kKey), "something else"));
  RecordedProgress reported;
  ASSERT_TRUE(stage.get(kKey, reported));
  EXPECT_EQ(reported.notes, "aaaaaaaaaaaaaaaa-text.txt is damaged and is computed again");
}

TEST(StageCache, AResultThatCannotBeCachedIsReturned) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(io::write_text(folder / "cache", "a file in the way of the folder"));
  TextStage stage{StageCache(folder / "cache")};
  RecordedProgress reported;
  EXPECT_EQ(stage.get(kKey, reported).value(), "made for " + kKey);
  EXPECT_NE(reported.notes.find("text.txt is not cached"), std::string::npos) << reported.notes;
}

/// A text long enough that an incomplete read would be seen.
std::string long_text(const std::string& key) {
  std::string text;
  while (text.size() < 300000) text += key;
  return text;
}

/// Reads and writes a few entries of a shared cache. \returns whether every text was right and no
/// scratch file is left.
bool use_shared(const fs::path& folder, int process) {
  const fs::path scratch = folder / "scratch" / std::to_string(process);
  const StageCache cache(SharedCache{folder / "cache", scratch});
  bool is_right = true;
  for (int round = 0; round < 60; ++round) {
    const std::string key(64, char('a' + round % 3));
    const auto text = cache.get(
        "text.txt", key, Progress::none(),
        [](const fs::path& path) { return io::read_text(path, 1 << 20); },
        [&]() -> Result<std::string> { return long_text(key); },
        [](const fs::path& path, const std::string& made) { return io::write_text(path, made); });
    is_right = is_right && text && *text == long_text(key);
  }
  return is_right && (!fs::exists(scratch) || fs::is_empty(scratch));
}

TEST(StageCache, ConcurrentProcessesReadOnlyWholeEntries) {
  constexpr int kProcesses = 4;
  const test::TemporaryFolder folder;
  // One entry is damaged, one lacks its SHA-256, one is missing: all processes repair them at once.
  ASSERT_TRUE(use_shared(folder.path(), kProcesses));
  const StageCache cache(SharedCache{folder / "cache", folder / "scratch"});
  ASSERT_TRUE(io::write_text(cache.file("text.txt", std::string(64, 'a')), "damaged"));
  ASSERT_TRUE(fs::remove(digest_file(cache.file("text.txt", std::string(64, 'b')))));
  ASSERT_TRUE(fs::remove(cache.file("text.txt", std::string(64, 'c'))));
  std::vector<pid_t> processes;
  for (int k = 0; k < kProcesses; ++k) {
    processes.push_back(::fork());
    if (processes.back() == 0) ::_exit(use_shared(folder.path(), k) ? 0 : 1);
  }
  for (const pid_t process : processes) {
    int status = 0;
    ::waitpid(process, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  for (const char c : {'a', 'b', 'c'})
    EXPECT_TRUE(check_digest(cache.file("text.txt", std::string(64, c))));
}

/// Readers may have mapped it.
TEST(StageCache, APublishedFileIsNotReplacedUnlessItIsDamaged) {
  const test::TemporaryFolder folder;
  const fs::path target = folder / "entry";
  const auto publish_text = [&](const std::string& text) {
    ASSERT_TRUE(io::write_text(folder / "made", text));
    const auto published = publish(folder / "made", target);
    ASSERT_TRUE(published) << published.error().message;
  };
  publish_text("first");
  publish_text("second");
  EXPECT_EQ(io::read_text(target, 100).value(), "first");
  ASSERT_TRUE(io::write_text(target, "damaged"));
  publish_text("third");
  EXPECT_EQ(io::read_text(target, 100).value(), "third");
  EXPECT_TRUE(check_digest(target));
}

TEST(StageCache, ASharedCacheKeepsAllFiles) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(SharedCache{folder / "cache", folder / "scratch"})};
  for (char c = 'a'; c < 'm'; ++c) ASSERT_TRUE(stage.get(std::string(64, c)));
  for (char c = 'a'; c < 'm'; ++c) ASSERT_TRUE(stage.get(std::string(64, c)));
  EXPECT_EQ(stage.made, 12);
}

}  // namespace
}  // namespace lefort::pipeline::test_stage_cache
