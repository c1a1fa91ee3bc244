/// \file
/// Temporary folders for patient data.
#pragma once

#include <lefort/io/internal/descriptor.h>

#include <filesystem>

namespace lefort::io {

/// A temporary folder that only this user can read, since images contain names. It is removed with
/// its files at the end of its life.
///
/// A process that is killed leaves its folder: the next one removes those of this user that no
/// process locks any more.
class PrivateFolder {
 public:
  /// \param parent  folder for temporary files.
  explicit PrivateFolder(const std::filesystem::path& parent);
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }  ///< Empty on failure.

 private:
  std::filesystem::path path_;
  Descriptor lock_;  ///< Of the folder itself (flock).
};

}  // namespace lefort::io
