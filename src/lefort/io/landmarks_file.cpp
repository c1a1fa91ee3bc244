#include <lefort/core/check.h>
#include <lefort/io/internal/csv.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/markups_file.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

namespace lefort::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxLandmarkBytes = 64 << 20;  // Bytes.
constexpr double kMaxLandmark_mm = 1e5;                 // As in plans.

bool is_markups(const fs::path& file) { return file.filename().string().ends_with(".mrk.json"); }
bool is_table(const fs::path& file) { return file.extension() == ".csv"; }

Result<plan::Landmarks> points_of(const std::vector<Markup>& markups) {
  plan::Landmarks landmarks;
  for (const Markup& markup : markups)
    if (markup.type == "Fiducial" || markup.type == "PointList")
      landmarks.insert(landmarks.end(), markup.points.begin(), markup.points.end());
  return checked_landmarks(std::move(landmarks));
}

/// Columns of a table; the point in L is lps * the three columns.
struct Columns {
  std::size_t name = 0;
  std::array<std::size_t, 3> position{};
  Vec3 lps = Vec3::Ones();
  std::optional<std::size_t> defined;
};

std::optional<std::size_t> find(const std::vector<std::string>& heading, const char* column) {
  const auto found = std::find(heading.begin(), heading.end(), column);
  if (found == heading.end()) return std::nullopt;
  return std::size_t(found - heading.begin());
}

std::optional<Columns> columns_of(const std::vector<std::string>& heading) {
  struct System {
    std::array<const char*, 3> names;
    Vec3 lps;
  };
  const std::array<System, 3> systems{{{{"x_mm", "y_mm", "z_mm"}, {1, 1, 1}},
                                       {{"l", "p", "s"}, {1, 1, 1}},
                                       {{"r", "a", "s"}, {-1, -1, 1}}}};
  Columns columns;
  const auto name = find(heading, "name"), label = find(heading, "label");
  if (!name && !label) return std::nullopt;
  columns.name = name ? *name : *label;
  columns.defined = find(heading, "defined");
  for (const auto& [names, lps] : systems) {
    std::size_t found = 0;
    for (; found < 3; ++found) {
      const auto column = find(heading, names[found]);
      if (!column) break;
      columns.position[found] = *column;
    }
    columns.lps = lps;
    if (found == 3) return columns;
  }
  return std::nullopt;
}

std::optional<double> number_in(const std::string& field) {
  const std::size_t start = field.find_first_not_of(" \t+");
  if (start == std::string::npos) return std::nullopt;
  const char* const end = field.data() + field.find_last_not_of(" \t") + 1;
  double number = 0.0;
  const auto [stop, error] = std::from_chars(field.data() + start, end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

/// Parses a line; nothing if the landmark is not placed.
Result<std::optional<plan::Landmark>> read_row(const std::vector<std::string>& fields,
                                               const Columns& columns, Index line) {
  const std::size_t last =
      std::max(columns.name, *std::max_element(columns.position.begin(), columns.position.end()));
  if (fields.size() <= last)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("line {} has {} fields, expected {}", line, fields.size(), last + 1));
  if (columns.defined && *columns.defined < fields.size() && fields[*columns.defined] == "0")
    return std::nullopt;
  plan::Landmark landmark{fields[columns.name], Vec3::Zero()};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto number = number_in(fields[columns.position[axis]]);
    if (!number)
      return fail(ErrorCode::kFileCorrupt, fmt::format("line {}: '{}' is not a finite number", line,
                                                       fields[columns.position[axis]]));
    landmark.point_L[Index(axis)] = columns.lps[Index(axis)] * *number;
  }
  return landmark;
}

std::string landmark_table(std::span<const plan::Landmark> landmarks,
                           std::span<const std::string> remarks) {
  std::string text = "name,x_mm,y_mm,z_mm,meaning\n";
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const auto& [name, p_L] = landmarks[i];
    const std::string remark = remarks.empty() ? "" : "; " + remarks[i];
    text += fmt::format("{},{},{},{},{}\n", internal::csv_field(name), p_L.x(), p_L.y(), p_L.z(),
                        internal::csv_field(plan::full_name(name) + remark));
  }
  return text;
}

std::string number_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : std::string();
}

}  // namespace

Result<plan::Landmarks> checked_landmarks(plan::Landmarks landmarks) {
  const auto bad = [](std::string what) { return fail(ErrorCode::kFileCorrupt, std::move(what)); };
  if (landmarks.empty()) return bad("it has no landmark");
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i].name.empty()) return bad(fmt::format("landmark {} has no name", i + 1));
    if (std::any_of(landmarks[i].name.begin(), landmarks[i].name.end(),
                    [](unsigned char c) { return std::iscntrl(c) != 0; }))
      return bad(fmt::format("landmark {} has a name with control characters", i + 1));
    const Vec3& point_L = landmarks[i].point_L;
    if (!point_L.allFinite() || point_L.cwiseAbs().maxCoeff() > kMaxLandmark_mm)
      return bad(fmt::format("landmark {} is beyond {:g} mm", landmarks[i].name, kMaxLandmark_mm));
  }
  if (const auto repeated = plan::first_repeated_name(landmarks))
    return bad(fmt::format("landmark {} is repeated", *repeated));
  return landmarks;
}

Result<plan::Landmarks> parse_landmark_table(std::string_view text) {
  std::optional<Columns> columns;
  plan::Landmarks landmarks;
  for (Index number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    if (line.empty() || line.front() == '#') continue;
    const auto fields = internal::split_csv(line);
    if (!fields)
      return fail(ErrorCode::kFileCorrupt, fmt::format("line {}: a quote is not closed", number));
    if (!columns) {
      columns = columns_of(*fields);
      if (!columns)
        return fail(ErrorCode::kFileCorrupt,
                    fmt::format("line {} must name the columns: name, and x_mm, y_mm, z_mm or l, "
                                "p, s or r, a, s",
                                number));
      continue;
    }
    LEFORT_TRY(const auto landmark, read_row(*fields, *columns, number));
    if (landmark) landmarks.push_back(*landmark);
  }
  return checked_landmarks(std::move(landmarks));
}

Result<plan::Landmarks> read_landmarks(const fs::path& file) {
  LEFORT_TRY_VOID(check_landmarks_ending(file));
  Result<plan::Landmarks> landmarks = plan::Landmarks();
  if (is_markups(file)) {
    LEFORT_TRY(const std::vector<Markup> markups, read_markups(file));
    landmarks = points_of(markups);
  } else {
    LEFORT_TRY(const std::string text, read_text(file, kMaxLandmarkBytes));
    landmarks = parse_landmark_table(text);
  }
  if (!landmarks)
    return fail(landmarks.error().code,
                fmt::format("landmarks {}: {}", file.string(), landmarks.error().message));
  return landmarks;
}

Result<void> write_landmarks(const fs::path& file, std::span<const plan::Landmark> landmarks,
                             std::span<const std::string> remarks) {
  LEFORT_TRY_VOID(check_landmarks_ending(file));
  if (is_markups(file)) return write_point_list(file, "landmarks", landmarks, remarks);
  return write_text(file, landmark_table(landmarks, remarks));
}

Result<void> check_landmarks_ending(const fs::path& file) {
  if (is_markups(file) || is_table(file)) return {};
  return fail(ErrorCode::kFileUnsupported,
              fmt::format("landmarks {}: must end in .mrk.json or .csv", file.string()));
}

std::string cephalometric_csv(std::span<const plan::Measurement> before,
                              std::span<const plan::Measurement> after) {
  LEFORT_CHECK(after.empty() || after.size() == before.size());
  std::string text = "measurement,meaning,unit,before";
  text += after.empty() ? "\n" : ",after,change\n";
  for (std::size_t i = 0; i < before.size(); ++i) {
    const plan::Measurement& line = before[i];
    text += fmt::format("{},{},{},{}", internal::csv_field(line.name),
                        internal::csv_field(line.meaning), line.unit, number_text(line.value));
    if (!after.empty()) {
      std::optional<double> change;
      if (line.value && after[i].value) change = *after[i].value - *line.value;
      text += fmt::format(",{},{}", number_text(after[i].value), number_text(change));
    }
    text += '\n';
  }
  return text;
}

}  // namespace lefort::io
