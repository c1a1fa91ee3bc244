/// \file
/// Where results go.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <span>
#include <vector>

namespace lefort::io {

/// Makes sure that a folder is there and can be written, before hours of work depend on it.
///
/// \returns nothing, or kFileUnwritable. A folder that could not be used is not left behind.
[[nodiscard]] Result<void> make_output_folder(const std::filesystem::path& folder);

/// Leaves no folder for results that never came: those on the way to `folder` that were not there
/// when it began, and are empty when it ends, go.
class EmptyFolderCleanup {
 public:
  explicit EmptyFolderCleanup(const std::filesystem::path& folder);
  ~EmptyFolderCleanup();
  EmptyFolderCleanup(const EmptyFolderCleanup&) = delete;
  EmptyFolderCleanup& operator=(const EmptyFolderCleanup&) = delete;

 private:
  std::vector<std::filesystem::path> new_;  ///< The deepest first.
};

/// Removes what an earlier run may have left; a file that is not there is none to remove.
///
/// \returns nothing, or kFileUnwritable with the name of the first that stays.
[[nodiscard]] Result<void> remove_earlier_files(std::span<const std::filesystem::path> files);

}  // namespace lefort::io
