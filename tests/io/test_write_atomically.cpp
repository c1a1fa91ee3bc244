#include <lefort/core/check.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>

#include "support/temporary_folder.h"

namespace lefort::io::test_write_atomically {
namespace {

constexpr std::uintmax_t kSmall = 1000;

TEST(WriteAtomically, ReadsBackTheWrittenBytes) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "a.txt", "face"));
  EXPECT_EQ(read_text(folder / "a.txt", kSmall).value(), "face");
  EXPECT_EQ(folder.entry_count(), 1);
}

TEST(WriteAtomically, PreservesTheOldFileIfTheWriterFails) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "a.txt", "old"));
  const auto half_written = write_atomically(folder / "a.txt", [](const auto& temporary) {
    EXPECT_TRUE(write_text(temporary, "half"));
    return Result<void>(fail(ErrorCode::kCancelled, "stopped"));
  });
  EXPECT_EQ(half_written.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(read_text(folder / "a.txt", kSmall).value(), "old");
  EXPECT_EQ(folder.entry_count(), 1);
}

TEST(WriteAtomically, ConvertsAnExceptionOfTheWriterToAnError) {
  const test::TemporaryFolder folder;
  const auto thrown = write_atomically(folder / "a.txt", [](const auto&) -> Result<void> {
    throw std::runtime_error("library trouble");
  });
  EXPECT_EQ(thrown.error().code, ErrorCode::kFileUnwritable);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(WriteAtomically, RethrowsALogicErrorAndLeavesNothing) {
  const test::TemporaryFolder folder;
  const auto write_with_a_bug = [&] {
    static_cast<void>(write_atomically(folder / "a.txt", [](const auto& temporary) {
      EXPECT_TRUE(write_text(temporary, "half"));
      LEFORT_CHECK(1 + 1 == 3);
      return Result<void>();
    }));
  };
  EXPECT_THROW(write_with_a_bug(), LogicError);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(WriteAtomically, ReportsTooLittleMemory) {
  const test::TemporaryFolder folder;
  const auto thrown = write_atomically(folder / "a.txt",
                                       [](const auto&) -> Result<void> { throw std::bad_alloc(); });
  ASSERT_FALSE(thrown);
  EXPECT_NE(thrown.error().message.find("not enough memory"), std::string::npos);
}

TEST(WriteAtomically, DoesNotFollowALinkAtTheTemporaryName) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "victim.txt", "untouched"));
  // A predictable name would contain the process number.
  const auto trap = folder / (".partial-" + std::to_string(::getpid()) + "-a.txt");
  std::filesystem::create_symlink(folder / "victim.txt", trap);
  ASSERT_TRUE(write_text(folder / "a.txt", "face"));
  EXPECT_EQ(read_text(folder / "victim.txt", kSmall).value(), "untouched");
  EXPECT_EQ(read_text(folder / "a.txt", kSmall).value(), "face");
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "a.txt"));
}

TEST(WriteAtomically, TwoWritersOfOneFileUseDifferentTemporaryFiles) {
  const test::TemporaryFolder folder;
  const auto outer = write_atomically(folder / "a.txt", [&](const auto& temporary) {
    EXPECT_TRUE(write_text(temporary, "outer"));
    EXPECT_TRUE(write_text(folder / "a.txt", "inner"));
    return Result<void>();
  });
  ASSERT_TRUE(outer) << outer.error().message;
  EXPECT_EQ(read_text(folder / "a.txt", kSmall).value(), "outer");
  EXPECT_EQ(folder.entry_count(), 1);
}

TEST(WriteAtomically, NamesAMissingFolder) {
  const auto lost = write_text("/nonexistent/a.txt", "face");
  EXPECT_EQ(lost.error().code, ErrorCode::kFileUnwritable);
  EXPECT_NE(lost.error().message.find("/nonexistent/a.txt"), std::string::npos);
}

TEST(ReadText, RejectsMissingAndOversizedFiles) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_text(folder / "none", kSmall).error().code, ErrorCode::kFileNotFound);
  ASSERT_TRUE(write_text(folder / "big", std::string(kSmall + 1, 'x')));
  EXPECT_EQ(read_text(folder / "big", kSmall).error().code, ErrorCode::kFileCorrupt);
}

}  // namespace
}  // namespace lefort::io::test_write_atomically
