/// \file
/// Cache of results of costly stages, with the hash of their inputs as key.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace lefort::pipeline {

/// A folder of intermediate results. Files are written atomically, so an interrupted run leaves
/// only complete files.
class StageCache {
 public:
  explicit StageCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// \param name  of the stage with a file ending, for example "field.field".
  /// \param key   hash of every input and option of the stage.
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& key) const {
    return folder_ / fmt::format("{}-{}", key.substr(0, 16), name);
  }

  /// Reads a cached result, as a stage of its own, or computes and stores it. A damaged file is
  /// computed again; a result that cannot be stored is returned, with a note.
  ///
  /// \param read   returns Result<T> from a path.
  /// \param make   returns Result<T>.
  /// \param write  writes a T to a path.
  /// \returns the result, or what `make` returns.
  template <class Read, class Make, class Write>
  [[nodiscard]] auto get(const std::string& name, const std::string& key, Progress& progress,
                         const Read& read, const Make& make, const Write& write) const
      -> decltype(make()) {
    const std::filesystem::path path = file(name, key);
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
      progress.begin_stage(fmt::format("read {} from the cache", name));
      if (auto kept = read(path)) return kept;
      progress.note(fmt::format("{} is damaged and is computed again", path.string()));
    }
    auto made = make();
    if (!made) return made;
    std::filesystem::create_directories(folder_, error);
    if (const Result<void> kept = write(path, *made); !kept)
      progress.note(fmt::format("{} is not cached: {}", name, kept.error().message));
    return made;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace lefort::pipeline
