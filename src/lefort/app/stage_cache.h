/// \file
/// Keeps what costly stages made, under the hash of all that went into them.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <fmt/format.h>

#include <filesystem>
#include <string>

namespace lefort::app {

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

  /// Reads what is there, or makes and keeps it. A kept file that cannot be read is made anew.
  template <class Read, class Make, class Write>
  [[nodiscard]] auto get(const std::string& name, const std::string& key, Progress& progress,
                         const Read& read, const Make& make, const Write& write) const
      -> decltype(make()) {
    const std::filesystem::path path = file(name, key);
    if (std::filesystem::exists(path)) {
      if (auto kept = read(path)) return kept;
      progress.note(fmt::format("{} is damaged and is made anew", path.string()));
    }
    auto made = make();
    if (!made) return made;
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error)
      return fail(ErrorCode::kFileUnwritable,
                  fmt::format("{} cannot be created: {}", folder_.string(), error.message()));
    LEFORT_TRY_VOID(write(path, *made));
    return made;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace lefort::app
