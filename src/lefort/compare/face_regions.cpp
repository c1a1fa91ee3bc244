#include <lefort/compare/face_regions.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lefort::compare {
namespace {

using plan::Landmark;

constexpr double kDepth_mm = 25.0;  // Of a region, posterior to its landmarks.
constexpr double kNoseWidthFactor = 1.15, kChinWidthFactor = 1.2, kCheekWidthFactor = 1.2;

/// Landmarks in the frame of the face: left, anterior, superior to the origin.
class LocalLandmarks {
 public:
  LocalLandmarks(std::span<const Landmark> landmarks_L, const Mat3& R_FL, const Vec3& middle_L)
      : landmarks_L_(landmarks_L), R_FL_(R_FL), middle_L_(middle_L) {}

  [[nodiscard]] std::optional<Vec3> midpoint(const char* name) const {
    const auto p_L = plan::pair_midpoint(landmarks_L_, name);
    return p_L ? std::optional<Vec3>(R_FL_ * (*p_L - middle_L_)) : std::nullopt;
  }
  /// Half of the distance between the landmarks of a pair, normal to the mid-plane.
  [[nodiscard]] std::optional<double> half_width(const std::string& name) const {
    const auto right = plan::find_landmark(landmarks_L_, name + "-R");
    const auto left = plan::find_landmark(landmarks_L_, name + "-L");
    if (!right || !left) return std::nullopt;
    return 0.5 * std::abs(R_FL_.row(0).dot(*left - *right));
  }

 private:
  std::span<const Landmark> landmarks_L_;
  Mat3 R_FL_;
  Vec3 middle_L_;
};

/// \returns the message that lists those of `names` whose landmark or pair is missing.
std::string missing_of(std::span<const Landmark> landmarks, FaceRegion region,
                       std::initializer_list<const char*> names) {
  std::string missing;
  for (const char* const name : names) {
    const plan::LandmarkKind* const kind = plan::landmark_definition(std::string(name) + "-R");
    const bool is_pair = kind != nullptr && kind->is_paired;
    const auto is_there = [&](const std::string& one) {
      return plan::find_landmark(landmarks, one).has_value();
    };
    if (is_pair ? is_there(std::string(name) + "-R") && is_there(std::string(name) + "-L")
                : is_there(name))
      continue;
    missing += (missing.empty() ? std::string(name_of(region)) + ": " : ", ") + name;
  }
  return missing;
}

}  // namespace

const char* name_of(FaceRegion region) {
  switch (region) {
    case FaceRegion::kElsewhere:
      return "elsewhere";
    case FaceRegion::kNose:
      return "nose";
    case FaceRegion::kUpperLip:
      return "upper lip";
    case FaceRegion::kLowerLip:
      return "lower lip";
    case FaceRegion::kChin:
      return "chin";
    case FaceRegion::kRightCheek:
      return "right cheek";
    case FaceRegion::kLeftCheek:
      return "left cheek";
  }
  return "";
}

Result<FaceRegions> FaceRegions::from(std::span<const Landmark> landmarks_L) {
  FaceRegions regions;
  LEFORT_TRY(const Vec3 left_L, plan::patient_left_axis(landmarks_L));
  const auto middle_of = [&](const char* name) { return plan::pair_midpoint(landmarks_L, name); };
  const auto top_L = middle_of("N'"), base_L = middle_of("Sn");
  const auto ear_L = middle_of("Po"), orbit_L = middle_of("Or");
  if (!base_L || (!top_L && !(ear_L && orbit_L))) {
    regions.missing_ = {"all regions: Sn, and N' or Po and Or"};
    return regions;
  }
  const auto across_left = [&](const Vec3& v) { return Vec3(v - v.dot(left_L) * left_L); };
  const Vec3 front_L = ear_L && orbit_L ? across_left(*orbit_L - *ear_L).normalized()
                                        : left_L.cross(across_left(*top_L - *base_L)).normalized();
  regions.R_FL_ << left_L.transpose(), front_L.transpose(), front_L.cross(left_L).transpose();
  regions.middle_L_ = *base_L;

  const LocalLandmarks local(landmarks_L, regions.R_FL_, regions.middle_L_);
  const auto needs = [&](FaceRegion region, std::initializer_list<const char*> names) {
    std::string missing = missing_of(landmarks_L, region, names);
    if (missing.empty()) return true;
    regions.missing_.push_back(std::move(missing));
    return false;
  };
  const double base_mm = 0.0;  // Heights are relative to Sn.
  if (needs(FaceRegion::kNose, {"N'", "Sn", "Al", "En"}))
    regions.parts_.push_back({FaceRegion::kNose, base_mm, local.midpoint("N'")->z(),
                              kNoseWidthFactor * *local.half_width("Al"), *local.half_width("En"),
                              local.midpoint("Al")->y() - kDepth_mm});
  if (needs(FaceRegion::kUpperLip, {"Sn", "Stm", "Ch"}))
    regions.parts_.push_back({FaceRegion::kUpperLip, local.midpoint("Stm")->z(), base_mm,
                              *local.half_width("Ch"), *local.half_width("Ch"),
                              local.midpoint("Ch")->y() - kDepth_mm});
  const auto fold_mm = [&] {
    return 0.5 * (local.midpoint("Li")->z() + local.midpoint("Pg'")->z());
  };
  if (needs(FaceRegion::kLowerLip, {"Stm", "Li", "Pg'", "Ch"}))
    regions.parts_.push_back({FaceRegion::kLowerLip, fold_mm(), local.midpoint("Stm")->z(),
                              *local.half_width("Ch"), *local.half_width("Ch"),
                              local.midpoint("Ch")->y() - kDepth_mm});
  if (needs(FaceRegion::kChin, {"Li", "Pg'", "Me'", "Ch"}))
    regions.parts_.push_back({FaceRegion::kChin, local.midpoint("Me'")->z(), fold_mm(),
                              kChinWidthFactor * *local.half_width("Ch"),
                              kChinWidthFactor * *local.half_width("Ch"),
                              local.midpoint("Ch")->y() - kDepth_mm});
  for (const auto& [region, side] :
       {std::pair(FaceRegion::kRightCheek, -1), std::pair(FaceRegion::kLeftCheek, 1)}) {
    if (!needs(region, {"En", "Ex"})) continue;
    const auto mouth = local.midpoint("Ch");
    const double width_mm = kCheekWidthFactor * *local.half_width("Ex");
    regions.parts_.push_back({region, mouth ? mouth->z() : base_mm, local.midpoint("En")->z(),
                              width_mm, width_mm, local.midpoint("Ex")->y() - kDepth_mm, side});
  }
  return regions;
}

bool FaceRegions::contains(const Part& part, const Vec3& local) const {
  if (local.z() < part.low_mm || local.z() >= part.high_mm || local.y() < part.behind_mm)
    return false;
  if (part.side != 0 && local.x() * part.side < 0.0) return false;
  const double fraction = (local.z() - part.low_mm) / (part.high_mm - part.low_mm);
  return std::abs(local.x()) <=
         part.width_low_mm + fraction * (part.width_high_mm - part.width_low_mm);
}

FaceRegion FaceRegions::at(const Vec3& p_L) const {
  const Vec3 local = R_FL_ * (p_L - middle_L_);
  for (const Part& part : parts_)
    if (contains(part, local)) return part.region;
  return FaceRegion::kElsewhere;
}

}  // namespace lefort::compare
