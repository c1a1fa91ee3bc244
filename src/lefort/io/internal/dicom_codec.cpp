#include <lefort/io/internal/dicom_codec.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <gdcmImage.h>
#include <gdcmImageReader.h>
#include <gdcmPixelFormat.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <span>
#include <thread>

namespace lefort::io {

namespace {

/// Exit codes of the decoding process. Any other end, such as a signal, means damaged.
enum ExitCode : int { kDecoded = 0, kDamaged = 1, kOtherType = 2, kNoMemory = 3 };

/// Zeroed memory shared with the child process.
class SharedDoubles {
 public:
  explicit SharedDoubles(std::size_t count)
      : bytes_(count * sizeof(double)),
        memory_(
            ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {}
  ~SharedDoubles() {
    if (is_valid()) ::munmap(memory_, bytes_);
  }
  SharedDoubles(const SharedDoubles&) = delete;
  SharedDoubles& operator=(const SharedDoubles&) = delete;

  [[nodiscard]] bool is_valid() const { return memory_ != MAP_FAILED; }
  [[nodiscard]] std::span<double> values() const {
    return {static_cast<double*>(memory_), bytes_ / sizeof(double)};
  }

 private:
  std::size_t bytes_;
  void* memory_;
};

template <class T>
ExitCode copy_as(const std::vector<char>& bytes, std::span<double> target) {
  if (bytes.size() != target.size() * sizeof(T)) return kDamaged;
  for (std::size_t n = 0; n < target.size(); ++n) {
    T value{};
    std::memcpy(&value, bytes.data() + n * sizeof(T), sizeof(T));
    target[n] = static_cast<double>(value);
  }
  return kDecoded;
}

ExitCode decode(const std::filesystem::path& file, std::span<double> target) {
  gdcm::ImageReader reader;
  reader.SetFileName(file.c_str());
  if (!reader.Read()) return kDamaged;
  const gdcm::Image& image = reader.GetImage();
  if (image.GetBufferLength() > target.size_bytes()) return kDamaged;
  std::vector<char> buffer(image.GetBufferLength());
  if (!image.GetBuffer(buffer.data())) return kDamaged;
  switch (image.GetPixelFormat().GetScalarType()) {
    case gdcm::PixelFormat::UINT8:
      return copy_as<std::uint8_t>(buffer, target);
    case gdcm::PixelFormat::INT8:
      return copy_as<std::int8_t>(buffer, target);
    case gdcm::PixelFormat::UINT12:
    case gdcm::PixelFormat::UINT16:
      return copy_as<std::uint16_t>(buffer, target);
    case gdcm::PixelFormat::INT12:
    case gdcm::PixelFormat::INT16:
      return copy_as<std::int16_t>(buffer, target);
    default:
      return kOtherType;
  }
}

/// Returns the current size of the address space, to which limits are relative.
std::size_t address_space_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

/// Runs in the child process: decodes without output, within limits, and exits.
[[noreturn]] void decode_and_exit(const std::filesystem::path& file, std::span<double> target,
                                  const CodecLimits& limits) {
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  // The parent enforces the deadline; this limit applies if the parent ends first.
  const auto time_s = static_cast<rlim_t>(limits.time.count() / 1000 + 1);
  const rlimit seconds{time_s, time_s};
  ::setrlimit(RLIMIT_CPU, &seconds);
  const rlim_t maximum = address_space_bytes() + limits.memory_bytes;
  const rlimit bytes{maximum, maximum};
  ::setrlimit(RLIMIT_AS, &bytes);
  int code = kDamaged;
  try {
    code = decode(file, target);
  } catch (const std::bad_alloc&) {
    code = kNoMemory;
  } catch (const std::exception&) {
    code = kDamaged;
  }
  ::_exit(code);  // Skips the clean-up, which is the parent's.
}

/// How the wait for the child process ended.
enum class WaitEnd { kExited, kTooLong, kStopped };

struct WaitResult {
  WaitEnd ending;
  int status;  ///< Of waitpid().
};

/// Waits for `child` and kills it at the deadline or on a request to stop. It has ended afterwards.
WaitResult wait_for(pid_t child, std::chrono::milliseconds time, const Progress& progress) {
  const auto deadline = std::chrono::steady_clock::now() + time;
  WaitResult waited{WaitEnd::kExited, 0};
  constexpr std::chrono::microseconds kMaxPause{20'000};
  for (std::chrono::microseconds pause{100};; pause = std::min(2 * pause, kMaxPause)) {
    const pid_t left = ::waitpid(child, &waited.status, WNOHANG);
    if (left == child || (left < 0 && errno != EINTR)) return waited;
    if (progress.stop_requested()) waited.ending = WaitEnd::kStopped;
    if (std::chrono::steady_clock::now() > deadline) waited.ending = WaitEnd::kTooLong;
    if (waited.ending != WaitEnd::kExited) break;
    std::this_thread::sleep_for(pause);
  }
  ::kill(child, SIGKILL);
  while (::waitpid(child, &waited.status, 0) < 0 && errno == EINTR) {
  }
  return waited;
}

}  // namespace

Result<std::vector<double>> decode_dicom_pixels(const std::filesystem::path& file,
                                                std::size_t pixels, Progress& progress,
                                                const CodecLimits& limits) {
  const SharedDoubles shared(pixels);
  const pid_t child = shared.is_valid() ? ::fork() : -1;
  if (child < 0) return fail(ErrorCode::kFileCorrupt, "the pixels do not fit into memory");
  if (child == 0) decode_and_exit(file, shared.values(), limits);
  const auto [ending, status] = wait_for(child, limits.time, progress);
  if (ending == WaitEnd::kStopped)
    return fail(ErrorCode::kCancelled, "decoding the pixels was stopped");
  if (ending == WaitEnd::kTooLong)
    return fail(
        ErrorCode::kFileCorrupt,
        fmt::format("the compressed pixels take longer than {} ms to decode", limits.time.count()));
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : kDamaged;
  if (code == kOtherType)
    return fail(ErrorCode::kFileUnsupported,
                "the compressed pixels are not integers of 8 or 16 bits");
  if (code == kNoMemory)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the compressed pixels need more than {} bytes of memory to decode",
                            limits.memory_bytes));
  if (code != kDecoded)
    return fail(ErrorCode::kFileCorrupt, "the compressed pixels are truncated or damaged");
  return std::vector<double>(shared.values().begin(), shared.values().end());
}

}  // namespace lefort::io
