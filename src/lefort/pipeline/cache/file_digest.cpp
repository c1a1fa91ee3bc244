#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cache/file_digest.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

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

Result<void> publish(const fs::path& made, const fs::path& target) {
  if (check_digest(target)) return {};
  const auto failed = [&](const std::error_code& error) {
    return fail(
        ErrorCode::kFileUnwritable,
        fmt::format("{} cannot be published: {}", target.filename().string(), error.message()));
  };
  LEFORT_TRY(const std::string sha256, io::sha256_of_file(made));
  const fs::path digest = digest_file(made);
  LEFORT_TRY_VOID(io::write_text(digest, digest_line(sha256, target)));
  std::error_code error;
  fs::rename(digest, digest_file(target), error);
  if (error) return failed(error);
  fs::create_hard_link(made, target, error);
  if (!error) return {};
  if (check_digest(target)) return {};  // Another process was faster.
  fs::rename(made, target, error);      // A damaged file, or a file system without hard links.
  if (error) return failed(error);
  return {};
}

void remove_oldest(const fs::path& folder, const std::string& name, std::size_t kept) {
  std::error_code error;
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    if (!entry->path().filename().string().ends_with(name)) continue;
    if (const auto written = entry->last_write_time(gone); !gone)
      files.emplace_back(written, entry->path());
  }
  std::sort(files.begin(), files.end());
  for (std::size_t n = 0; n + kept < files.size(); ++n) {
    fs::remove(digest_file(files[n].second), error);
    fs::remove(files[n].second, error);
  }
}

}  // namespace lefort::pipeline
