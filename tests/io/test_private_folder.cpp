// Images of a patient do not outlive the process that fetched them by more than the next one.
#include <lefort/io/internal/private_folder.h>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "support/temporary_folder.h"

namespace lefort::io::test_private_folder {
namespace {

namespace fs = std::filesystem;

TEST(PrivateFolder, IsPrivateAndRemovedWithItsFiles) {
  const test::TemporaryFolder parent;
  {
    const PrivateFolder folder(parent.path());
    ASSERT_FALSE(folder.path().empty());
    EXPECT_EQ(fs::status(folder.path()).permissions(), fs::perms::owner_all);
    std::ofstream(folder.path() / "1.dcm") << "x";
  }
  EXPECT_EQ(parent.entry_count(), 0);
}

TEST(PrivateFolder, OfAKilledProcessIsRemovedByTheNextOne) {
  const test::TemporaryFolder parent;
  std::ofstream(parent / "lefort-scan-file") << "not a folder";
  fs::create_directory(parent / "other");
  const pid_t child = ::fork();
  if (child == 0) {
    const PrivateFolder folder(parent.path());
    std::ofstream(folder.path() / "1.dcm") << "x";
    ::raise(SIGKILL);
  }
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  ASSERT_EQ(parent.entry_count(), 3);
  const PrivateFolder running(parent.path());
  EXPECT_EQ(parent.entry_count(), 3);  // The killed one's is gone.
  const PrivateFolder second(parent.path());
  EXPECT_EQ(parent.entry_count(), 4);
  EXPECT_TRUE(fs::exists(running.path()));
}

TEST(PrivateFolder, NeedsAWritableParent) {
  const test::TemporaryFolder parent;
  EXPECT_TRUE(PrivateFolder(parent / "missing").path().empty());
}

}  // namespace
}  // namespace lefort::io::test_private_folder
