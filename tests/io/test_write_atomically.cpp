#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>

#include <stdexcept>

#include "support/temporary_folder.h"

namespace lefort::io {
namespace {

constexpr std::uintmax_t kSmall = 1000;

TEST(WriteAtomically, WhatIsWrittenIsReadBack) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "a.txt", "face"));
  EXPECT_EQ(read_text(folder / "a.txt", kSmall).value(), "face");
  EXPECT_EQ(folder.entry_count(), 1);
}

TEST(WriteAtomically, AFailedWriterLeavesTheOldFileAndNothingElse) {
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

TEST(WriteAtomically, AThrowingWriterIsAnError) {
  const test::TemporaryFolder folder;
  const auto thrown = write_atomically(folder / "a.txt", [](const auto&) -> Result<void> {
    throw std::runtime_error("library trouble");
  });
  EXPECT_EQ(thrown.error().code, ErrorCode::kFileUnwritable);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(WriteAtomically, NamesAFolderThatIsNotThere) {
  const auto lost = write_text("/nonexistent/a.txt", "face");
  EXPECT_EQ(lost.error().code, ErrorCode::kFileUnwritable);
  EXPECT_NE(lost.error().message.find("/nonexistent/a.txt"), std::string::npos);
}

TEST(ReadText, RefusesMissingAndOversizedFiles) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_text(folder / "none", kSmall).error().code, ErrorCode::kFileNotFound);
  ASSERT_TRUE(write_text(folder / "big", std::string(kSmall + 1, 'x')));
  EXPECT_EQ(read_text(folder / "big", kSmall).error().code, ErrorCode::kFileCorrupt);
}

}  // namespace
}  // namespace lefort::io
