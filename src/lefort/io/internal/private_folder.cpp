#include <lefort/io/internal/private_folder.h>

#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kPrivatePrefix = "lefort-scan-";

/// Opens and locks a folder of this user; closed if that fails.
Descriptor locked_folder(const fs::path& folder) {
  Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat status {};
  const bool is_ours = opened.is_open() && ::fstat(opened.number(), &status) == 0 &&
                       status.st_uid == ::geteuid() &&
                       ::flock(opened.number(), LOCK_EX | LOCK_NB) == 0;
  return is_ours ? std::move(opened) : Descriptor();
}

/// Removes the folders of processes that have ended.
void remove_abandoned(const fs::path& parent) {
  std::error_code error;
  std::vector<fs::path> folders;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->path().filename().string().starts_with(kPrivatePrefix))
      folders.push_back(entry->path());
  for (const fs::path& folder : folders)
    if (const Descriptor lock = locked_folder(folder); lock.is_open())
      fs::remove_all(folder, error);
}

}  // namespace

PrivateFolder::PrivateFolder(const fs::path& parent) {
  remove_abandoned(parent);
  std::string name = (parent / kPrivatePrefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) return;
  lock_ = locked_folder(name);
  if (lock_.is_open()) path_ = name;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace lefort::io
