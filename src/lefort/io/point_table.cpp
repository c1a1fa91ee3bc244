#include <lefort/io/point_table.h>
#include <lefort/io/read_text.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

namespace lefort::io {
namespace {

constexpr std::uintmax_t kMaxPointTableBytes = std::uintmax_t(4) << 30;  // Bytes.
constexpr std::string_view kSeparators = " \t,;\r";

/// Removes one number from the front of `line`.
std::optional<double> take_number(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kSeparators), line.size()));
  if (line.starts_with('+')) line.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  line.remove_prefix(std::size_t(end - line.data()));
  if (!line.empty() && kSeparators.find(line.front()) == std::string_view::npos)
    return std::nullopt;
  return number;
}

std::optional<Vec3> parse_point(std::string_view line) {
  Vec3 point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> number = take_number(line);
    if (!number) return std::nullopt;
    point[axis] = *number;
  }
  return point;
}

bool is_heading(std::string_view line) {
  return std::isalpha(static_cast<unsigned char>(line.front())) != 0;
}

}  // namespace

Result<std::vector<Vec3>> parse_points(std::string_view text) {
  std::vector<Vec3> points;
  for (Index number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t start = line.find_first_not_of(kSeparators);
    if (start == std::string_view::npos || line[start] == '#') continue;
    const std::optional<Vec3> point = parse_point(line);
    if (point) {
      points.push_back(*point);
    } else if (number > 1 || !is_heading(line.substr(start))) {
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("line {} does not start with three finite numbers", number));
    }
  }
  if (points.empty()) return fail(ErrorCode::kFileCorrupt, "it has no point");
  return points;
}

Result<std::vector<Vec3>> read_points(const std::filesystem::path& file) {
  LEFORT_TRY(const std::string text, read_text(file, kMaxPointTableBytes));
  Result<std::vector<Vec3>> points = parse_points(text);
  if (!points)
    return fail(points.error().code,
                fmt::format("points {}: {}", file.string(), points.error().message));
  return points;
}

}  // namespace lefort::io
