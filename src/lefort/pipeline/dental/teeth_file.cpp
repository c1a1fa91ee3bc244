#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental/teeth_file.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <string>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxTeethBytes = 1 << 20;

tl::unexpected<Error> corrupt_teeth(const fs::path& file, const std::string& what) {
  return fail(ErrorCode::kFileCorrupt, fmt::format("{}: {}", file.string(), what));
}

/// The list of a document of version 1.
Result<nlohmann::json> list_in(const fs::path& file, const char* version, const char* list) {
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxTeethBytes));
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains(version) || json[version] != 1 || !json.contains(list) ||
      !json[list].is_array())
    return corrupt_teeth(file, fmt::format("no `{}`: 1 with a list `{}`", version, list));
  return json[list];
}

/// A whole number from 0 to 99; -1 if it is something else.
int number_in(const nlohmann::json& one, const char* key) {
  const auto at = one.is_object() ? one.find(key) : one.end();
  if (!one.is_object() || at == one.end() || !at->is_number_integer()) return -1;
  const auto value = at->get<std::int64_t>();
  return value >= 0 && value <= 99 ? int(value) : -1;
}

}  // namespace

Result<std::vector<dental::ToothCorrection>> read_tooth_corrections(
    const std::optional<fs::path>& file) {
  std::vector<dental::ToothCorrection> corrections;
  if (!file) return corrections;
  LEFORT_TRY(const nlohmann::json list, list_in(*file, "lefort_tooth_corrections", "corrections"));
  for (const nlohmann::json& one : list) {
    const dental::ToothCorrection correction{number_in(one, "found"), number_in(one, "fdi")};
    if (correction.found < 0 || correction.fdi < 0)
      return corrupt_teeth(*file, "a correction needs the whole numbers `found` and `fdi`");
    corrections.push_back(correction);
  }
  return corrections;
}

Result<void> write_tooth_corrections(const fs::path& file,
                                     std::span<const dental::ToothCorrection> corrections) {
  nlohmann::json list = nlohmann::json::array();
  for (const dental::ToothCorrection& one : corrections)
    list.push_back({{"found", one.found}, {"fdi", one.fdi}});
  return io::write_text(
      file, nlohmann::json{{"lefort_tooth_corrections", 1}, {"corrections", list}}.dump(1) + "\n");
}

Result<dental::NumberedCrowns> read_crowns(const fs::path& file) {
  LEFORT_TRY(const nlohmann::json list, list_in(file, "lefort_teeth", "teeth"));
  dental::NumberedCrowns crowns;
  for (const nlohmann::json& one : list) {
    const int fdi = number_in(one, "fdi");
    if (!dental::is_fdi_number(fdi) || !one.contains("crown") || !one["crown"].is_array() ||
        one["crown"].size() != 3)
      return corrupt_teeth(file, "a tooth needs `fdi` and `crown`");
    Vec3 at_L;
    for (Index axis = 0; axis < 3; ++axis) {
      const auto& value = one["crown"][std::size_t(axis)];
      if (!value.is_number()) return corrupt_teeth(file, "the position of a crown is not a number");
      at_L[axis] = value.get<double>();
    }
    const auto width = one.find("width_mm");
    const bool is_known = width != one.end() && !width->is_null();
    if (is_known &&
        !(width->is_number() && width->get<double>() > 0.0 && width->get<double>() < 30.0))
      return corrupt_teeth(file, fmt::format("the `width_mm` of tooth {} must be 0 to 30", fdi));
    const double width_mm =
        is_known ? width->get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!at_L.allFinite() || !crowns.emplace(fdi, dental::Crown{at_L, width_mm}).second)
      return corrupt_teeth(file, fmt::format("tooth {} is there twice, or not finite", fdi));
  }
  return crowns;
}

}  // namespace lefort::pipeline
