#include <lefort/io/output_folder.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <system_error>

namespace lefort::io {
namespace fs = std::filesystem;

Result<void> make_output_folder(const fs::path& folder) {
  std::error_code error;
  const bool is_new = fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder))
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("output folder {} cannot be created: {}", folder.string(),
                            error ? error.message() : "a file of that name exists"));
  const fs::path probe = folder / ".writable";
  const Result<void> written = write_text(probe, "");
  fs::remove(probe, error);
  if (written) return {};
  if (is_new) fs::remove(folder, error);
  return fail(ErrorCode::kFileUnwritable, fmt::format("output folder {} cannot be written: {}",
                                                      folder.string(), written.error().message));
}

EmptyFolderCleanup::EmptyFolderCleanup(const fs::path& folder) {
  std::error_code error;
  for (fs::path at = fs::absolute(folder, error).lexically_normal();
       !at.empty() && !fs::exists(fs::symlink_status(at, error)); at = at.parent_path()) {
    if (at.has_filename()) new_.push_back(at);  // "a/" and "a" are the same folder.
    if (at == at.parent_path()) break;
  }
}

EmptyFolderCleanup::~EmptyFolderCleanup() {
  std::error_code error;
  for (const fs::path& folder : new_)
    if (fs::is_directory(fs::symlink_status(folder, error)) && fs::is_empty(folder, error))
      fs::remove(folder, error);
}

Result<void> remove_earlier_files(std::span<const fs::path> files) {
  std::error_code error;
  for (const fs::path& file : files) {
    fs::remove(file, error);
    if (error)
      return fail(ErrorCode::kFileUnwritable,
                  fmt::format("{} of an earlier run cannot be removed: {}", file.string(),
                              error.message()));
  }
  return {};
}

}  // namespace lefort::io
