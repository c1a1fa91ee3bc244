#include <lefort/io/file_lock.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace lefort::io {
namespace {

namespace fs = std::filesystem;

/// Whether the open file still has this name: its owner may have removed it before we locked it.
bool has_name(int descriptor, const fs::path& file) {
  struct stat opened {
  }, named{};
  return ::fstat(descriptor, &opened) == 0 && ::stat(file.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

tl::unexpected<Error> failed(const fs::path& file, const char* what) {
  return fail(ErrorCode::kFileUnwritable,
              fmt::format("{} cannot be {}: {}", file.string(), what, std::strerror(errno)));
}

}  // namespace

Result<std::optional<FileLock>> FileLock::try_lock(const fs::path& file) {
  for (;;) {
    const int descriptor =
        ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0) return failed(file, "opened");
    FileLock lock(descriptor);
    while (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) return std::optional<FileLock>();
      if (errno != EINTR) return failed(file, "locked");
    }
    if (has_name(descriptor, file)) return std::optional<FileLock>(std::move(lock));
  }
}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  if (this == &other) return *this;
  release();
  descriptor_ = other.descriptor_;
  other.descriptor_ = -1;
  return *this;
}

Result<void> FileLock::append(std::string_view text) const {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0)
      return fail(ErrorCode::kFileUnwritable,
                  fmt::format("a log cannot be written: {}", std::strerror(errno)));
    text.remove_prefix(std::size_t(written));
  }
  return {};
}

void FileLock::release() {
  if (descriptor_ < 0) return;
  ::flock(descriptor_, LOCK_UN);  // A child process may have inherited the descriptor.
  ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace lefort::io
