/// \file
/// The folder of results.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <span>
#include <vector>

namespace lefort::io {

/// Creates a folder if necessary and checks that files can be written to it, before a long
/// computation.
///
/// \param folder  path of the folder.
/// \returns nothing, or kFileUnwritable; a folder that this call created is then removed.
[[nodiscard]] Result<void> make_output_folder(const std::filesystem::path& folder);

/// Removes empty folders after a failure: the destructor removes those on the path to `folder` that
/// are empty and did not exist when this object was made.
class EmptyFolderCleanup {
 public:
  explicit EmptyFolderCleanup(const std::filesystem::path& folder);
  ~EmptyFolderCleanup();
  EmptyFolderCleanup(const EmptyFolderCleanup&) = delete;
  EmptyFolderCleanup& operator=(const EmptyFolderCleanup&) = delete;

 private:
  std::vector<std::filesystem::path> new_;  ///< Deepest first.
};

/// Removes files of an earlier run.
///
/// \param files  need not exist.
/// \returns nothing, or kFileUnwritable with the name of the first file that cannot be removed.
[[nodiscard]] Result<void> remove_earlier_files(std::span<const std::filesystem::path> files);

}  // namespace lefort::io
