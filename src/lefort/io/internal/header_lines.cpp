#include <lefort/io/internal/header_lines.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>

namespace lefort::io {

Result<HeaderLines> HeaderLines::open(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string start(kMaxHeader, '\0');
  stream.read(start.data(), std::streamsize(start.size()));
  if (stream.bad() || !stream.is_open())
    return fail(ErrorCode::kFileNotFound, "the file cannot be read");
  start.resize(std::size_t(stream.gcount()));
  return HeaderLines(std::move(start));
}

Result<std::optional<std::string_view>> HeaderLines::next() {
  if (at_ == start_.size()) {
    if (at_ < kMaxHeader) return std::nullopt;
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the header has more than {} bytes", kMaxHeader));
  }
  ++number_;
  const std::string_view rest = std::string_view(start_).substr(at_);
  const std::size_t end = rest.substr(0, kMaxLine + 1).find('\n');
  if (end == std::string_view::npos && rest.size() > kMaxLine)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("line {} of the header has more than {} bytes", number_, kMaxLine));
  std::string_view line = rest.substr(0, end);
  at_ += end == std::string_view::npos ? rest.size() : end + 1;
  if (end != std::string_view::npos && line.ends_with('\r')) line.remove_suffix(1);
  if (std::any_of(line.begin(), line.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return (byte < 0x20 && c != '\t') || byte == 0x7f;
      }))
    return fail(
        ErrorCode::kFileCorrupt,
        fmt::format("line {} of the header contains a control character, expected text", number_));
  return line;
}

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

}  // namespace lefort::io
