#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cache/file_digest.h>

#include <fmt/format.h>

#include <string>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxDigestFile = 4096;

std::string digest_line(const std::string& sha256, const fs::path& file) {
  return fmt::format("{}  {}\n", sha256, file.filename().string());
}

}  // namespace

fs::path digest_file(const fs::path& file) { return file.string() + ".sha256"; }

Result<void> write_digest(const fs::path& file) {
  LEFORT_TRY(const std::string sha256, io::sha256_of_file(file));
  return io::write_text(digest_file(file), digest_line(sha256, file));
}

Result<void> check_digest(const fs::path& file) {
  LEFORT_TRY(const std::string stored, io::read_text(digest_file(file), kMaxDigestFile));
  LEFORT_TRY(const std::string sha256, io::sha256_of_file(file));
  if (stored == digest_line(sha256, file)) return {};
  return fail(ErrorCode::kFileCorrupt,
              fmt::format("{} does not have its SHA-256", file.filename().string()));
}

}  // namespace lefort::pipeline
