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

tl::unexpected<Error> corrupt_arches(const fs::path& file, const std::string& what) {
  return fail(ErrorCode::kFileCorrupt,
              fmt::format("{}: {}; make it with `lefort dental register`", file.string(), what));
}

Result<nlohmann::json> read_arches(const fs::path& file) {
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxArchesBytes));
  auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("lefort_arches") || json["lefort_arches"] != 1)
    return corrupt_arches(file, "not an arches.json of version 1");
  return json;
}

/// The motion of one intraoral scan into the frame of the CT.
Result<RigidTransform> scan_motion(const nlohmann::json& arches, const char* jaw,
                                   const fs::path& file) {
  constexpr const char* kPose = "pose_4x4_row_major_mm_lps";
  constexpr double kTolerance = 1e-6;
  const auto arch = arches.find(jaw);
  if (arch == arches.end())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} has no {} jaw: register both scans", file.string(), jaw));
  if (!arch->is_object() || !arch->contains(kPose) || !(*arch)[kPose].is_array() ||
      (*arch)[kPose].size() != 16)
    return corrupt_arches(file, "no motion of a scan");
  RigidTransform X = RigidTransform::Identity();
  for (Index n = 0; n < 12; ++n) {
    const auto& value = (*arch)[kPose][std::size_t(n)];
    if (!value.is_number()) return corrupt_arches(file, "a motion is not a number");
    X.matrix()(n / 4, n % 4) = value.get<double>();
  }
  const Mat3 R = X.linear();
  if (!X.matrix().allFinite() ||
      !((R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff() < kTolerance) ||
      R.determinant() < 0.0)
    return corrupt_arches(file, "a motion is not rigid");
  return X;
}

/// The directions of the upper arch, or else of the lower one.
Result<ArchDirections> directions_in(const fs::path& file) {
  LEFORT_TRY(const nlohmann::json json, read_arches(file));
  const auto corrupt = [&](const std::string& what) { return corrupt_arches(file, what); };
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

Result<RigidTransform> scanned_occlusion(const fs::path& arches) {
  LEFORT_TRY(const nlohmann::json json, read_arches(arches));
  LEFORT_TRY(const RigidTransform X_L_upper, scan_motion(json, "upper", arches));
  LEFORT_TRY(const RigidTransform X_L_lower, scan_motion(json, "lower", arches));
  return RigidTransform(X_L_upper * X_L_lower.inverse());
}

Result<ArchDirections> read_arch_directions(const std::optional<fs::path>& arches) {
  if (!arches) return ArchDirections{};
  return directions_in(*arches);
}

}  // namespace lefort::pipeline
