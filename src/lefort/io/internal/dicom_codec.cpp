#include <lefort/io/internal/dicom_codec.h>

#include <fcntl.h>
#include <gdcmImage.h>
#include <gdcmImageReader.h>
#include <gdcmPixelFormat.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>
#include <span>

namespace lefort::io {

namespace {

constexpr rlim_t kMaxSeconds = 20;  // For one slice; the slowest codecs take one.

/// How the decoding process ends. All else, signals too, means damaged.
enum ExitCode : int { kDecoded = 0, kDamaged = 1, kOtherType = 2 };

/// Zeroed memory that a child process shares with us.
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

/// What the child process does: decode in silence, within limits, and leave.
[[noreturn]] void decode_and_exit(const std::filesystem::path& file, std::span<double> target) {
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const rlimit seconds{kMaxSeconds, kMaxSeconds};
  ::setrlimit(RLIMIT_CPU, &seconds);
  int code = kDamaged;
  try {
    code = decode(file, target);
  } catch (const std::exception&) {
    code = kDamaged;
  }
  ::_exit(code);  // Without the clean-up that is the parent's.
}

}  // namespace

Result<std::vector<double>> decode_dicom_pixels(const std::filesystem::path& file,
                                                std::size_t pixels) {
  const SharedDoubles shared(pixels);
  const pid_t child = shared.is_valid() ? ::fork() : -1;
  if (child < 0) return fail(ErrorCode::kFileCorrupt, "the pixels do not fit into memory");
  if (child == 0) decode_and_exit(file, shared.values());
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : kDamaged;
  if (code == kOtherType)
    return fail(ErrorCode::kFileUnsupported,
                "the compressed pixels are no whole numbers of 8 or 16 bits");
  if (code != kDecoded)
    return fail(ErrorCode::kFileCorrupt, "the compressed pixels are truncated or damaged");
  return std::vector<double>(shared.values().begin(), shared.values().end());
}

}  // namespace lefort::io
