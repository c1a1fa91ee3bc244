#include <lefort/io/internal/volume_header.h>

namespace lefort::io {
namespace fs = std::filesystem;

Result<fs::path> sibling_file(const fs::path& header, std::string_view name) {
  while (name.starts_with("./")) name.remove_prefix(2);
  // LIST means several files in both formats.
  if (name.empty() || name == "." || name == ".." || name.starts_with("LIST") ||
      name.find_first_of("/\\%\0", 0, 4) != std::string_view::npos)
    return fail(ErrorCode::kFileUnsupported,
                "the voxels are not in one file in the folder of the header, expected its name "
                "without a path");
  fs::path file = header.parent_path() / name;
  std::error_code error;
  // Checks the file itself; links are not followed.
  if (!fs::is_regular_file(fs::symlink_status(file, error)))
    return fail(ErrorCode::kFileCorrupt,
                "the voxel file is missing in the folder of the header or is not a regular file");
  return file;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

}  // namespace lefort::io
