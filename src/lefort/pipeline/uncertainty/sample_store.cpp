#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/uncertainty/sample_store.h>

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <system_error>

namespace lefort::pipeline {
namespace {

constexpr std::size_t kSampleDigest = 64;                // Hexadecimal digits of SHA-256.
constexpr std::size_t kHead = 2 + sizeof(std::int64_t);  // Kind, start, Newton iterations.
constexpr std::uintmax_t kMaxSampleBytes = 1 << 28;

}  // namespace

SampleStore::SampleStore(const std::filesystem::path& folder, const std::string& key)
    : folder_(folder / key.substr(0, 16)) {}

std::filesystem::path SampleStore::file(const std::string& kind, Index sample) const {
  return folder_ / fmt::format("{}-{:05}.sample", kind, sample);
}

std::optional<SampleResult> SampleStore::read(const std::string& kind, Index sample,
                                              std::size_t vertices) const {
  const Result<std::string> text = io::read_text(file(kind, sample), kMaxSampleBytes);
  if (!text || text->size() < kSampleDigest + kHead) return std::nullopt;
  const std::string body = text->substr(kSampleDigest);
  if (io::Sha256().add(body).hex() != text->substr(0, kSampleDigest)) return std::nullopt;
  SampleResult result;
  result.is_from_rest = body[1] == 'R';
  std::int64_t iterations = 0;
  std::memcpy(&iterations, body.data() + 2, sizeof iterations);
  result.newton_iterations = Index(iterations);
  const std::size_t bytes = body.size() - kHead;
  if (body[0] == 'F') {
    result.failure = body.substr(kHead);
    if (result.failure.empty()) return std::nullopt;
    return result;
  }
  if (body[0] != 'D' || bytes != vertices * sizeof(float)) return std::nullopt;
  result.normal_mm.resize(vertices);
  std::memcpy(result.normal_mm.data(), body.data() + kHead, bytes);
  return result;
}

Result<void> SampleStore::write(const std::string& kind, Index sample,
                                const SampleResult& result) const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  std::string body{result.is_solved() ? 'D' : 'F', result.is_from_rest ? 'R' : 'N'};
  const auto iterations = std::int64_t(result.newton_iterations);
  body.append(reinterpret_cast<const char*>(&iterations), sizeof iterations);
  if (result.is_solved())
    body.append(reinterpret_cast<const char*>(result.normal_mm.data()),
                result.normal_mm.size() * sizeof(float));
  else
    body += result.failure;
  return io::write_text(file(kind, sample), io::Sha256().add(body).hex() + body);
}

}  // namespace lefort::pipeline
