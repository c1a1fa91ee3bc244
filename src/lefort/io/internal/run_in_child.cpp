#include <lefort/core/printable.h>
#include <lefort/io/internal/run_in_child.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <new>
#include <utility>

namespace lefort::io {

namespace {

using Clock = std::chrono::steady_clock;

/// How the wait for a child ended.
enum class WaitEnd { kEnded, kTooLong, kStopped };

/// Waits for the end of a child and kills it at the deadline or on a request to stop. It has ended
/// afterwards.
WaitEnd wait_for(const Descriptor& process, std::chrono::milliseconds time,
                 const Progress& progress) {
  constexpr int kBetweenStops_ms = 10;
  const auto deadline = Clock::now() + time;
  pollfd event{process.number(), POLLIN, 0};
  WaitEnd ending = WaitEnd::kEnded;
  while (::poll(&event, 1, kBetweenStops_ms) <= 0) {
    if (progress.stop_requested()) ending = WaitEnd::kStopped;
    if (Clock::now() > deadline) ending = WaitEnd::kTooLong;
    if (ending == WaitEnd::kEnded) continue;
    ::syscall(SYS_pidfd_send_signal, process.number(), SIGKILL, nullptr, 0);
    while (::poll(&event, 1, -1) <= 0) {
    }
    break;
  }
  return ending;
}

/// Seals and maps the file of a result; nothing if that fails.
std::shared_ptr<const void> mapped(const Descriptor& file, std::size_t size) {
  constexpr int kSeals = F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE;
  if (::fcntl(file.number(), F_ADD_SEALS, kSeals) != 0) return nullptr;
  void* const start = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number(), 0);
  if (start == MAP_FAILED) return nullptr;
  return {start, [size](const void* memory) {
            ::munmap(const_cast<void*>(memory), size);  // NOLINT: as mapped.
          }};
}

/// The error of a task, whose text is not trusted.
Error error_of(const ResultHeader& header, std::span<const std::byte> text,
               const std::string& subject) {
  constexpr std::size_t kMaxMessage = 4096;
  constexpr auto kLastCode = static_cast<std::uint32_t>(ErrorCode::kConnectionFailed);
  if (header.error > kLastCode || text.size() > kMaxMessage) return damaged_result(subject);
  return {static_cast<ErrorCode>(header.error),
          printable({reinterpret_cast<const char*>(text.data()), text.size()})};
}

}  // namespace

Result<OpenedFile> open_input(const std::filesystem::path& file,
                              const std::string& name_in_messages) {
  OpenedFile input{Descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK))};
  const int number = input.descriptor.number();
  struct stat status {};
  if (number < 0 || ::fstat(number, &status) != 0 || ::fcntl(number, F_SETFL, O_RDONLY) != 0)
    return fail(ErrorCode::kFileNotFound, fmt::format("{} cannot be read", name_in_messages));
  if (S_ISREG(status.st_mode)) input.bytes = static_cast<std::uint64_t>(status.st_size);
  return input;
}

Result<OpenedFile> open_input(const std::filesystem::path& file, std::uint64_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return fail(ErrorCode::kFileNotFound, fmt::format("{} is not a file", file.string()));
  LEFORT_TRY(OpenedFile input, open_input(file, file.string()));
  if (input.bytes > max_bytes)
    return fail(ErrorCode::kFileCorrupt, fmt::format("{} has {} bytes, expected at most {}",
                                                     file.string(), input.bytes, max_bytes));
  return input;
}

ReaderLimits limits_of(std::uint64_t text_bytes, std::uint64_t memory_bytes) {
  constexpr std::uint64_t kMinBytesPerMs = 1000;
  constexpr std::chrono::milliseconds kStart{60'000};
  return {kStart + std::chrono::milliseconds(text_bytes / kMinBytesPerMs),
          (std::size_t{1} << 30) + static_cast<std::size_t>(memory_bytes)};
}

Error damaged_result(const std::string& subject) {
  return {ErrorCode::kFileCorrupt, fmt::format("{} are truncated or damaged", subject)};
}

Result<ReaderValues> run_in_child(const Descriptor& input, const ReaderJob& job,
                                  Progress& progress) {
  const auto stopped = [&] {
    return fail(ErrorCode::kCancelled, fmt::format("reading {} was stopped", job.subject));
  };
  if (progress.stop_requested()) return stopped();
  LEFORT_TRY(const ReaderChild child, start_child(job.task, input, job.request, job.limits));
  const WaitEnd ending = wait_for(child.process, job.limits.time, progress);
  if (ending == WaitEnd::kStopped) return stopped();
  if (ending == WaitEnd::kTooLong)
    return fail(ErrorCode::kFileCorrupt, fmt::format("{} take longer than {} ms to read",
                                                     job.subject, job.limits.time.count()));
  struct stat status {};
  const bool has_size = ::fstat(child.result.number(), &status) == 0;
  const auto size = has_size ? static_cast<std::size_t>(status.st_size) : 0;
  ResultHeader header;
  if (size < sizeof(header)) return tl::unexpected(damaged_result(job.subject));
  const std::shared_ptr<const void> mapping = mapped(child.result, size);
  if (mapping == nullptr)
    return fail(ErrorCode::kOutOfMemory, fmt::format("{} do not fit into memory", job.subject));
  std::memcpy(static_cast<void*>(&header), mapping.get(), sizeof(header));
  const std::span bytes(static_cast<const std::byte*>(mapping.get()), size);
  if (header.magic != ResultHeader::kComplete || header.length > size - sizeof(header))
    return tl::unexpected(damaged_result(job.subject));
  const std::span values = bytes.subspan(sizeof(header), static_cast<std::size_t>(header.length));
  rlimit file_size{};
  if (header.state == ResultHeader::kNoMemory && ::getrlimit(RLIMIT_FSIZE, &file_size) == 0 &&
      file_size.rlim_cur < job.limits.memory_bytes)
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("{} cannot be written to a file in memory: files may have {} bytes "
                            "(ulimit -f)",
                            job.subject, file_size.rlim_cur));
  if (header.state == ResultHeader::kNoMemory)
    return fail(ErrorCode::kFileCorrupt, fmt::format("{} need more than {} bytes of memory to read",
                                                     job.subject, job.limits.memory_bytes));
  if (header.state != ResultHeader::kRead)
    return tl::unexpected(error_of(header, values, job.subject));
  return ReaderValues(mapping, values);
}

Result<std::string> read_all(int input, const std::string& subject) {
  struct stat status {};
  std::string bytes;
  if (::fstat(input, &status) == 0 && S_ISREG(status.st_mode))
    bytes.resize(static_cast<std::size_t>(status.st_size));
  constexpr std::size_t kStep = 1 << 16;
  std::size_t length = 0;
  while (true) {
    if (length == bytes.size()) bytes.resize(length + kStep);
    const ssize_t got = ::read(input, bytes.data() + length, bytes.size() - length);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return tl::unexpected(damaged_result(subject));
    if (got == 0) break;
    length += static_cast<std::size_t>(got);
  }
  bytes.resize(length);
  return bytes;
}

}  // namespace lefort::io
