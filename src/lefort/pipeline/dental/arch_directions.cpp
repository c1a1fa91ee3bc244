#include <lefort/io/read_text.h>
#include <lefort/pipeline/dental/arch_directions.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxArchesBytes = 1 << 20;

/// The directions of the upper arch, or else of the lower one.
Result<ArchDirections> directions_in(const fs::path& file) {
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxArchesBytes));
  const auto json = nlohmann::json::parse(text, nullptr, false);
  const auto corrupt = [&](const std::string& what) {
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{}: {}; make it with `lefort dental register`", file.string(), what));
  };
  if (!json.is_object() || !json.contains("lefort_arches") || json["lefort_arches"] != 1)
    return corrupt("not an arches.json of version 1");
  const bool is_upper = json.contains("upper");
  const auto arch = json.find(is_upper ? "upper" : "lower");
  if (arch == json.end() || !arch->is_object()) return corrupt("no jaw");
  dental::ArchAxes axes;
  for (const auto& [name, to] :
       {std::pair{"occlusal", &axes.superior_L}, {"anterior", &axes.anterior_L}}) {
    const auto at = arch->find(name);
    if (at == arch->end() || !at->is_array() || at->size() != 3) return corrupt("no directions");
    for (int i = 0; i < 3; ++i) {
      const auto& value = (*at)[std::size_t(i)];
      if (!value.is_number()) return corrupt("a direction is not a number");
      (*to)[i] = value.get<double>();
    }
    if (!to->allFinite() || std::abs(to->norm() - 1.0) > 1e-3)
      return corrupt("a direction is not of unit length");
  }
  if (is_upper) axes.superior_L = -axes.superior_L;
  if (std::abs(axes.superior_L.dot(axes.anterior_L)) > 1e-3)
    return corrupt("the directions are not perpendicular");
  return ArchDirections{axes, is_upper ? anatomy::Tooth::kUpper : anatomy::Tooth::kLower};
}

}  // namespace

Result<ArchDirections> read_arch_directions(const std::optional<fs::path>& arches) {
  if (!arches) return ArchDirections{};
  return directions_in(*arches);
}

}  // namespace lefort::pipeline
