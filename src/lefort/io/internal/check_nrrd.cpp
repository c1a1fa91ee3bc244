#include <lefort/io/internal/check_volume_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <map>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr int kMaxNrrdLines = 10'000;

std::string lower_case_field(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Returns the fields of the header by name in lower case without spaces, since spaces are optional
/// ("data file", "datafile"). Key/value pairs (":=") are omitted.
std::map<std::string, std::string> read_fields(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::map<std::string, std::string> fields;
  std::string line;
  for (int n = 0; n < kMaxNrrdLines && std::getline(stream, line); ++n) {
    if (trimmed(line).empty()) break;  // The voxels follow.
    const std::size_t colon = line.find(':');
    if (line.starts_with('#') || colon == std::string::npos) continue;
    if (line.compare(colon, 2, ":=") == 0) continue;
    std::string name = lower_case_field(line.substr(0, colon));
    std::erase(name, ' ');
    fields[name] = trimmed(std::string_view(line).substr(colon + 1));
  }
  return fields;
}

/// Whether all units are mm; quotes are optional.
bool are_mm(std::string units) {
  std::replace(units.begin(), units.end(), '"', ' ');
  for (std::string_view rest = trimmed(units); !rest.empty();) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (lower_case_field(rest.substr(0, end)) != "mm") return false;
    rest = trimmed(rest.substr(end));
  }
  return true;
}

/// Whether a separate voxel file can contain `bytes` after the skipped bytes.
Result<void> check_size(const fs::path& voxels, const std::map<std::string, std::string>& fields,
                        std::uint64_t bytes) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(voxels, error);
  const auto field = [&](const char* name) {
    const auto found = fields.find(name);
    return found == fields.end() ? std::string() : lower_case_field(found->second);
  };
  const bool is_raw = field("encoding") == "raw";
  std::uint64_t skipped = 0;  // ITK handles -1 (count from the end) and invalid values.
  const std::string skip = field("byteskip");
  std::from_chars(skip.data(), skip.data() + skip.size(), skipped);
  const std::uint64_t stored = error || size < skipped ? 0 : size - skipped;
  if (is_raw ? stored < bytes : stored < bytes / kMaxGzipRatio)
    return tl::unexpected(missing_voxels(stored, bytes));
  return {};
}

}  // namespace

Result<void> check_nrrd_voxel_file(const fs::path& file) {
  const auto fields = read_fields(file);
  const auto voxels = fields.find("datafile");
  if (voxels == fields.end()) return {};
  LEFORT_TRY([[maybe_unused]] const fs::path beside, sibling_file(file, voxels->second));
  return {};
}

Result<void> check_nrrd(const fs::path& file, std::uint64_t bytes) {
  auto fields = read_fields(file);
  const std::string space = lower_case_field(fields["space"]);
  if (space != "left-posterior-superior" && space != "lps" && space != "right-anterior-superior" &&
      space != "ras")
    return fail(
        ErrorCode::kFileUnsupported,
        "the header has no space LPS or RAS, expected one so that left and right are known");
  if (!fields.contains("spacedirections"))
    return fail(ErrorCode::kFileUnsupported,
                "the header has no space directions, expected them so that left and right are "
                "known");
  if (!are_mm(fields["spaceunits"]))
    return fail(ErrorCode::kFileUnsupported, "the space units are not mm, expected mm");
  if (!fields.contains("datafile")) return {};
  LEFORT_TRY(const fs::path voxels, sibling_file(file, fields["datafile"]));
  return check_size(voxels, fields, bytes);
}

}  // namespace lefort::io
