/// \file
/// Cache of results of costly stages, with the hash of their inputs as key.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/cache/file_digest.h>

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace lefort::pipeline {

/// A folder of intermediate results. Files are written atomically, so an interrupted run leaves
/// only complete files. Beside each file is its SHA-256, which is checked before the file is read:
/// most formats have no checksum, and a wrong bit of a mesh would change the predicted face
/// unnoticed. Of each name the files that were used last are kept.
class StageCache {
 public:
  explicit StageCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// \param name  of the result with its file ending, for example "tissue.vtu".
  /// \param key   hash of every input and option of the result, 16 characters or more.
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& key) const {
    return folder_ / fmt::format("{}-{}", key.substr(0, 16), name);
  }

  /// Reads a cached result, or computes and stores it. Reading is reported as a stage. If the file
  /// is damaged or has another SHA-256, the result is computed again, with a note. A result that
  /// cannot be stored is returned, with a note.
  ///
  /// \param read   returns Result<T> from a path.
  /// \param make   returns Result<T>.
  /// \param write  writes a T to a path.
  /// \returns the result, or the error of `make`.
  template <class Read, class Make, class Write>
  [[nodiscard]] auto get(const std::string& name, const std::string& key, Progress& progress,
                         const Read& read, const Make& make, const Write& write) const
      -> decltype(make()) {
    const std::filesystem::path path = file(name, key);
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
      progress.begin_stage(fmt::format("read {} from the cache", name));
      if (check_digest(path))
        if (auto kept = read(path)) {
          std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now(),
                                           error);
          return kept;
        }
      progress.note(fmt::format("{} is damaged and is computed again", path.filename().string()));
    }
    auto made = make();
    if (!made) return made;
    std::filesystem::create_directories(folder_, error);
    std::filesystem::remove(digest_file(path), error);
    Result<void> kept = write(path, *made);
    if (kept) kept = write_digest(path);
    if (!kept) progress.note(fmt::format("{} is not cached: {}", name, kept.error().message));
    remove_oldest(folder_, "-" + name, kMaxFiles);
    return made;
  }

 private:
  static constexpr std::size_t kMaxFiles = 8;  ///< Of one name: as many plans can be compared.

  std::filesystem::path folder_;
};

}  // namespace lefort::pipeline
