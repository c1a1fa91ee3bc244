#include <lefort/io/read_text.h>

#include <fmt/format.h>

#include <fstream>
#include <system_error>

namespace lefort::io {
namespace fs = std::filesystem;

Result<std::string> read_text(const fs::path& source, std::uintmax_t max_bytes) {
  std::error_code error;
  if (!fs::is_regular_file(source, error))
    return fail(ErrorCode::kFileNotFound, fmt::format("{} is not a file", source.string()));
  const std::uintmax_t size = fs::file_size(source, error);
  if (error || size > max_bytes)
    return fail(ErrorCode::kFileCorrupt, fmt::format("{} has {} bytes, expected at most {}",
                                                     source.string(), size, max_bytes));
  std::string text(std::size_t(size), '\0');
  std::ifstream file(source, std::ios::binary);
  if (!file.read(text.data(), std::streamsize(size)))
    return fail(ErrorCode::kFileNotFound, fmt::format("{} cannot be read", source.string()));
  return text;
}

}  // namespace lefort::io
