#include <lefort/app/stage_cache.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace lefort::app {
namespace {

namespace fs = std::filesystem;

/// A stage that makes a text and counts how often it had to.
struct TextStage {
  StageCache cache;
  int made = 0;

  Result<std::string> get(const std::string& key) {
    return cache.get(
        "text.txt", key, Progress::none(),
        [](const fs::path& path) { return io::read_text(path, 100); },
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

TEST(StageCache, OtherInputsAreMadeAnew) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.get(kOtherKey).value(), "made for " + kOtherKey);
  EXPECT_EQ(stage.made, 2);
}

TEST(StageCache, ADamagedFileIsMadeAnew) {
  const test::TemporaryFolder folder;
  TextStage stage{StageCache(folder / "cache")};
  ASSERT_TRUE(stage.get(kKey));
  ASSERT_TRUE(io::write_text(stage.cache.file("text.txt", kKey), std::string(200, 'x')));
  EXPECT_EQ(stage.get(kKey).value(), "made for " + kKey);
  EXPECT_EQ(stage.made, 2);
}

}  // namespace
}  // namespace lefort::app
