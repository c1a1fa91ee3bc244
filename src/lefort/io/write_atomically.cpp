#include <lefort/io/write_atomically.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

Error unwritable(const fs::path& target, const std::string& why) {
  return {ErrorCode::kFileUnwritable,
          fmt::format("{} cannot be written: {}", target.string(), why)};
}

/// Returns an unpredictable name, so that no link can be placed there, with the ending of `target`.
fs::path temporary_name(const fs::path& target) {
  std::random_device random;
  const std::uint64_t number = (std::uint64_t{random()} << 32U) | random();
  return target.parent_path() /
         fmt::format("{}{:016x}-{}", kPartialPrefix, number, target.filename().string());
}

/// Syncs the file to disk and closes it; closing alone does not guarantee writing.
class SyncedDescriptor {
 public:
  explicit SyncedDescriptor(int number) : number_(number) {}
  ~SyncedDescriptor() {
    if (is_open()) ::close(number_);
  }
  SyncedDescriptor(const SyncedDescriptor&) = delete;
  SyncedDescriptor& operator=(const SyncedDescriptor&) = delete;
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  [[nodiscard]] bool sync() const { return ::fsync(number_) == 0; }

 private:
  int number_;
};

/// Removes the temporary file unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Returns the last line of a library's message, which contains the cause in ITK and NRRD.
std::string last_line(std::string_view text) {
  text = text.substr(0, text.find_last_not_of(" \n\r\t") + 1);
  return std::string(text.substr(text.find_last_of('\n') + 1));
}

/// Calls `write`. Exceptions of libraries become errors; those that indicate bugs are rethrown.
Result<void> fill(const fs::path& temporary, const fs::path& target,
                  const std::function<Result<void>(const fs::path&)>& write) {
  try {
    return write(temporary);
  } catch (const std::logic_error&) {  // Includes LogicError.
    throw;
  } catch (const std::bad_alloc&) {
    return tl::unexpected(unwritable(target, "there is not enough memory"));
  } catch (const std::exception& exception) {
    return tl::unexpected(unwritable(target, last_line(exception.what())));
  }
}

}  // namespace

Result<void> write_atomically(const fs::path& target,
                              const std::function<Result<void>(const fs::path&)>& write) {
  const fs::path name = temporary_name(target);
  const auto by_errno = [&] { return tl::unexpected(unwritable(target, std::strerror(errno))); };
  {  // Checks the folder first, since the messages of libraries are long.
    const SyncedDescriptor made(
        ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!made.is_open()) return by_errno();
  }
  const TemporaryFile temporary(name);
  LEFORT_TRY_VOID(fill(temporary.path(), target, write));
  {  // The bytes must be on disk before the name.
    const SyncedDescriptor written(::open(name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
    if (!written.is_open() || !written.sync()) return by_errno();
  }
  std::error_code error;
  fs::rename(temporary.path(), target, error);
  if (error) return tl::unexpected(unwritable(target, error.message()));
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const SyncedDescriptor entries(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems cannot sync a folder; the file is complete nevertheless.
  if (entries.is_open() && !entries.sync() && errno == EIO) return by_errno();
  return {};
}

Result<void> write_text(const fs::path& target, std::string_view text) {
  return write_atomically(target, [&](const fs::path& temporary) -> Result<void> {
    std::ofstream file(temporary, std::ios::binary);
    file.write(text.data(), std::streamsize(text.size()));
    file.close();
    if (!file) return tl::unexpected(unwritable(target, "the disk is full or failing"));
    return {};
  });
}

}  // namespace lefort::io
