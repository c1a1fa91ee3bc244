/// \file
/// Cache of results of costly stages, with the hash of their inputs as key.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/cache/file_digest.h>

#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace lefort::pipeline {

/// A cache that several processes use at the same time.
struct SharedCache {
  std::filesystem::path folder;
  /// Of this process alone, on the file system of `folder`: for unfinished files and files that no
  /// other process reads.
  std::filesystem::path scratch;
};

/// A folder of intermediate results. Files are written atomically, so an interrupted run leaves
/// only complete files. Beside each file is its SHA-256, which is checked before the file is read:
/// most formats have no checksum, and a wrong bit of a mesh would change the predicted face
/// unnoticed.
///
/// A private cache keeps the files of each name that were used last. A shared cache keeps all: a
/// file that another process has mapped must not vanish. A file is published there by one rename or
/// link, after its SHA-256, and never replaced unless it is damaged.
class StageCache {
 public:
  /// A private cache.
  explicit StageCache(std::filesystem::path folder) : folder_(std::move(folder)) {}
  explicit StageCache(SharedCache shared)
      : folder_(std::move(shared.folder)), scratch_(std::move(shared.scratch)) {}

  /// \param name  of the result with its file ending, for example "tissue.vtu".
  /// \param key   hash of every input and option of the result, 16 characters or more.
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& key) const {
    return folder_ / name_of(name, key);
  }

  /// As file(), of a file that no other process uses.
  [[nodiscard]] std::filesystem::path private_file(const std::string& name,
                                                   const std::string& key) const {
    return scratch_.value_or(folder_) / name_of(name, key);
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
    const Result<void> kept =
        store(path, [&](const std::filesystem::path& target) { return write(target, *made); });
    if (!kept) progress.note(fmt::format("{} is not cached: {}", name, kept.error().message));
    if (!scratch_) remove_oldest(folder_, "-" + name, kMaxFiles);
    return made;
  }

 private:
  static constexpr std::size_t kMaxFiles = 8;  ///< Of one name: as many plans can be compared.
  static constexpr std::size_t kKeyLength = 16;

  [[nodiscard]] static std::string name_of(const std::string& name, const std::string& key) {
    return fmt::format("{}-{}", key.substr(0, kKeyLength), name);
  }
  [[nodiscard]] Result<void> store(
      const std::filesystem::path& path,
      const std::function<Result<void>(const std::filesystem::path&)>& write) const;

  std::filesystem::path folder_;
  std::optional<std::filesystem::path> scratch_{};  ///< Of a shared cache.
};

}  // namespace lefort::pipeline
