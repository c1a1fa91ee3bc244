#include <lefort/io/write_atomically.h>

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

Error unwritable(const fs::path& target, const std::string& why) {
  return {ErrorCode::kFileUnwritable,
          fmt::format("{} cannot be written: {}", target.string(), why)};
}

/// Removes the temporary file unless it was renamed away.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target)
      : path_(target.parent_path() /
              fmt::format(".partial-{}-{}", ::getpid(), target.filename().string())) {}
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

}  // namespace

Result<void> write_atomically(const fs::path& target,
                              const std::function<Result<void>(const fs::path&)>& write) {
  const TemporaryFile temporary(target);
  {  // Libraries report an unwritable folder in many words; ask the system first.
    const std::ofstream probe(temporary.path(), std::ios::binary);
    if (!probe) return tl::unexpected(unwritable(target, std::strerror(errno)));
  }
  try {
    LEFORT_TRY_VOID(write(temporary.path()));
  } catch (const std::exception& exception) {
    return tl::unexpected(unwritable(target, exception.what()));
  }
  std::error_code error;
  fs::rename(temporary.path(), target, error);
  if (error) return tl::unexpected(unwritable(target, error.message()));
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

Result<std::string> read_text(const fs::path& source, std::uintmax_t max_bytes) {
  std::error_code error;
  if (!fs::is_regular_file(source, error))
    return fail(ErrorCode::kFileNotFound, fmt::format("{} is not a file", source.string()));
  const std::uintmax_t size = fs::file_size(source, error);
  if (error || size > max_bytes)
    return fail(ErrorCode::kFileCorrupt, fmt::format("{} has {} bytes, expected at most {}",
                                                     source.string(), size, max_bytes));
  std::string text(std::size_t(size), '\0');
  std::ifstream file(source, std::ios::binary);
  if (!file.read(text.data(), std::streamsize(size)))
    return fail(ErrorCode::kFileNotFound, fmt::format("{} cannot be read", source.string()));
  return text;
}

}  // namespace lefort::io
