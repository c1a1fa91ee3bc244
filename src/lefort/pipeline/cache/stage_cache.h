/// \file
/// Keeps what costly stages made, under the hash of all that went into them.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace lefort::pipeline {

/// A folder of finished intermediate results. Files appear whole or not at all, so an interrupted
/// run leaves only what the next one can use.
class StageCache {
 public:
  explicit StageCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// \param name  of the stage and file ending, as "field.field".
  /// \param key   hash of every input and option of the stage.
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& key) const {
    return folder_ / fmt::format("{}-{}", key.substr(0, 16), name);
  }

  /// Reads what is there, as a stage of its own, or makes and keeps it. A kept file that cannot be
  /// read is made anew; a result that cannot be kept serves all the same, with a note.
  template <class Read, class Make, class Write>
  [[nodiscard]] auto get(const std::string& name, const std::string& key, Progress& progress,
                         const Read& read, const Make& make, const Write& write) const
      -> decltype(make()) {
    const std::filesystem::path path = file(name, key);
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
      progress.begin_stage(fmt::format("read {} from the cache", name));
      if (auto kept = read(path)) return kept;
      progress.note(fmt::format("{} is damaged and is made anew", path.string()));
    }
    auto made = make();
    if (!made) return made;
    std::filesystem::create_directories(folder_, error);
    if (const Result<void> kept = write(path, *made); !kept)
      progress.note(fmt::format("{} is not kept for the next run: {}", name, kept.error().message));
    return made;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace lefort::pipeline
