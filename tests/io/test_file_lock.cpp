#include <lefort/io/file_lock.h>
#include <lefort/io/read_text.h>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "support/temporary_folder.h"

namespace lefort::io::test_file_lock {
namespace {

/// A process that locks a file, reports it, and waits to be killed.
pid_t start_owner(const std::filesystem::path& file) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  const pid_t owner = ::fork();
  if (owner == 0) {
    const auto lock = FileLock::try_lock(file);
    const char has_lock = lock && *lock ? '1' : '0';
    if (::write(ends[1], &has_lock, 1) == 1)
      for (;;) ::pause();
    ::_exit(1);
  }
  char has_lock = 0;
  EXPECT_EQ(::read(ends[0], &has_lock, 1), 1);
  EXPECT_EQ(has_lock, '1');
  ::close(ends[0]);
  ::close(ends[1]);
  return owner;
}

TEST(FileLock, ExcludesOtherProcessesUntilItsOwnerIsKilled) {
  const test::TemporaryFolder folder;
  const pid_t owner = start_owner(folder / "lock");
  const auto refused = FileLock::try_lock(folder / "lock");
  ASSERT_TRUE(refused) << refused.error().message;
  EXPECT_FALSE(refused->has_value());
  ::kill(owner, SIGKILL);
  ::waitpid(owner, nullptr, 0);
  const auto lock = FileLock::try_lock(folder / "lock");
  ASSERT_TRUE(lock);
  EXPECT_TRUE(lock->has_value());
}

/// A child that was forked meanwhile, such as a reader of scans, does not keep the lock.
TEST(FileLock, EndsWithItsObjectAlthoughAChildInheritedTheFile) {
  const test::TemporaryFolder folder;
  pid_t child = 0;
  {
    const auto lock = FileLock::try_lock(folder / "lock");
    ASSERT_TRUE(lock && *lock);
    child = ::fork();
    if (child == 0)
      for (;;) ::pause();
  }
  const auto again = FileLock::try_lock(folder / "lock");
  EXPECT_TRUE(again && again->has_value());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

TEST(FileLock, AppendsAndKeepsWhatAnEarlierOwnerWrote) {
  const test::TemporaryFolder folder;
  for (const char* line : {"one\n", "two\n"}) {
    const auto lock = FileLock::try_lock(folder / "lock");
    ASSERT_TRUE(lock && *lock);
    EXPECT_TRUE((*lock)->append(line));
  }
  EXPECT_EQ(read_text(folder / "lock", 100).value(), "one\ntwo\n");
}

TEST(FileLock, AFileThatCannotBeMadeIsReported) {
  const test::TemporaryFolder folder;
  const auto lock = FileLock::try_lock(folder / "missing/lock");
  ASSERT_FALSE(lock);
  EXPECT_EQ(lock.error().code, ErrorCode::kFileUnwritable);
}

}  // namespace
}  // namespace lefort::io::test_file_lock
