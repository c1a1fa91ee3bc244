/// \file
/// A lock between processes that ends with its process.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <optional>
#include <string_view>

namespace lefort::io {

/// Exclusive lock (flock) on a file. The kernel releases it when the process ends, also after
/// SIGKILL: no lock outlives its owner. On NFS the server holds it, so it excludes processes of
/// other machines; it ends there with the lease of a machine that fails. Child processes do not
/// keep it.
class FileLock {
 public:
  /// Locks `file` without waiting; creates it if it does not exist.
  ///
  /// \returns the lock; nothing if another process has it; or kFileUnwritable.
  [[nodiscard]] static Result<std::optional<FileLock>> try_lock(const std::filesystem::path& file);

  FileLock(FileLock&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock() { release(); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// Appends bytes to the locked file; they are never overwritten.
  ///
  /// \returns nothing, or kFileUnwritable.
  [[nodiscard]] Result<void> append(std::string_view text) const;

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  void release();

  int descriptor_;
};

}  // namespace lefort::io
