#include <lefort/io/internal/mapped_file.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace lefort::io {

namespace {

/// Closes a file at the end of its scope; a mapping remains valid.
struct OpenFile {
  int number;
  ~OpenFile() {
    if (number >= 0) ::close(number);
  }
};

tl::unexpected<Error> unreadable(const std::filesystem::path& path, const char* why) {
  return fail(ErrorCode::kFileNotFound, fmt::format("cannot read {}: {}", path.string(), why));
}

}  // namespace

Result<MappedFile> map_file(const std::filesystem::path& path) {
  // Non-blocking, since opening a pipe without a writer never returns.
  const OpenFile file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  struct stat status {};
  if (file.number < 0 || ::fstat(file.number, &status) != 0)
    return unreadable(path, std::strerror(errno));
  if (!S_ISREG(status.st_mode)) return unreadable(path, "it is not a regular file");
  const auto size = std::size_t(status.st_size);
  if (size == 0) return MappedFile{};
  void* const start = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number, 0);
  if (start == MAP_FAILED) return unreadable(path, std::strerror(errno));
  return MappedFile{
      {static_cast<const std::byte*>(start), size},
      std::shared_ptr<const void>(start, [size](void* mapped) { ::munmap(mapped, size); })};
}

}  // namespace lefort::io
