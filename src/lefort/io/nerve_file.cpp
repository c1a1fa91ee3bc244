#include <lefort/io/nerve_file.h>
#include <lefort/io/read_text.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace lefort::io {
namespace {

constexpr std::uintmax_t kMaxNerveBytes = 1 << 24;
constexpr double kMaxNerveCoordinate_mm = 1e5, kMaxCanalRadius_mm = 10.0;

/// Three finite numbers.
bool read_point(const nlohmann::json& json, Vec3& p_L) {
  if (!json.is_array() || json.size() != 3) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& value = json[std::size_t(axis)];
    if (!value.is_number()) return false;
    p_L[axis] = value.get<double>();
    if (!(std::abs(p_L[axis]) <= kMaxNerveCoordinate_mm)) return false;
  }
  return true;
}

/// One canal; a message if it is invalid.
tl::expected<predict::NerveTube, std::string> read_canal(const nlohmann::json& canal,
                                                         const char* side) {
  if (!canal.is_object() || !canal.contains("points") || !canal["points"].is_array() ||
      canal["points"].size() < 2 || !canal.contains("radius_mm") || !canal["radius_mm"].is_number())
    return tl::unexpected(fmt::format("the {} canal has no points or no radius", side));
  predict::NerveTube nerve{side, {}, canal["radius_mm"].get<double>()};
  if (!(nerve.radius_mm >= 0.0 && nerve.radius_mm <= kMaxCanalRadius_mm))
    return tl::unexpected(
        fmt::format("the radius of the {} canal must be 0 to {:g} mm", side, kMaxCanalRadius_mm));
  for (const auto& point : canal["points"]) {
    Vec3 p_L;
    if (!read_point(point, p_L))
      return tl::unexpected(fmt::format("a point of the {} canal is not three numbers", side));
    nerve.line_L.push_back(p_L);
  }
  return nerve;
}

}  // namespace

Result<Nerves> read_nerves(const std::filesystem::path& file) {
  LEFORT_TRY(const std::string text, read_text(file, kMaxNerveBytes));
  const auto corrupt = [&](const std::string& what) {
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{}: {}; make it with `lefort nerve`", file.string(), what));
  };
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("lefort_nerve") || json["lefort_nerve"] != 1)
    return corrupt("not a nerve.json of version 1");
  Nerves nerves;
  if (json.contains("ct_sha256") && json["ct_sha256"].is_string())
    nerves.ct_sha256 = json["ct_sha256"].get<std::string>();
  for (const char* const side : {"right", "left"}) {
    const auto canal = json.find(side);
    if (canal == json.end()) {
      nerves.notes.push_back(fmt::format("{} has no {} canal", file.string(), side));
      continue;
    }
    auto tube = read_canal(*canal, side);
    if (!tube) return corrupt(tube.error());
    nerves.canals.push_back(*std::move(tube));
    constexpr double kVisible = 0.6;
    if (canal->contains("visible_fraction") && (*canal)["visible_fraction"].is_number() &&
        (*canal)["visible_fraction"].get<double>() < kVisible)
      nerves.notes.push_back(
          fmt::format("the {} canal is hardly visible: its distances are uncertain", side));
  }
  if (nerves.canals.empty()) return corrupt("it has no canal");
  return nerves;
}

}  // namespace lefort::io
