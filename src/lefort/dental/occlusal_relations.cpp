#include <lefort/dental/occlusal_relations.h>

#include <cmath>
#include <limits>

namespace lefort::dental {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

const Crown* crown_of(const NumberedCrowns& crowns, int fdi) {
  const auto at = crowns.find(fdi);
  return at == crowns.end() ? nullptr : &at->second;
}

/// Unit vector at a tooth to mesial, from the nearest tooth along `step` (1 to distal, -1 to
/// mesial). \returns nothing if there is no other tooth within the quadrant.
std::optional<Vec3> mesial_at(const NumberedCrowns& crowns, int fdi, int step) {
  const Crown* const tooth = crown_of(crowns, fdi);
  for (int number = fdi % 10 + step; tooth != nullptr && number >= 1 && number <= 8; number += step)
    if (const Crown* const next = crown_of(crowns, fdi / 10 * 10 + number)) {
      const Vec3 along = -double(step) * (next->center_L - tooth->center_L);
      if (along.norm() > 0.0) return along.normalized();
    }
  return std::nullopt;
}

/// From the upper canine to the distal end of the lower one.
double canine_relation(const NumberedCrowns& crowns, int upper, int lower,
                       const RigidTransform& X) {
  const Crown *const above = crown_of(crowns, upper), *const below = crown_of(crowns, lower);
  const auto mesial = mesial_at(crowns, lower, 1);
  if (above == nullptr || below == nullptr || !mesial) return kUnknown;
  const Vec3 end = X * Vec3(below->center_L - 0.5 * below->width_mm * *mesial);
  return (end - above->center_L).dot(X.linear() * *mesial);
}

/// From the mesiobuccal cusp of the upper first molar to the buccal groove of the lower one.
double molar_relation(const NumberedCrowns& crowns, int upper, int lower, const RigidTransform& X) {
  constexpr double kCusp = 0.25, kGroove = 0.1;
  const Crown *const above = crown_of(crowns, upper), *const below = crown_of(crowns, lower);
  const auto ahead = mesial_at(crowns, upper, -1), mesial = mesial_at(crowns, lower, -1);
  if (above == nullptr || below == nullptr || !ahead || !mesial) return kUnknown;
  const Vec3 cusp = above->center_L + kCusp * above->width_mm * *ahead;
  const Vec3 groove = X * Vec3(below->center_L + kGroove * below->width_mm * *mesial);
  return (groove - cusp).dot(X.linear() * *mesial);
}

}  // namespace

std::string_view angle_class(double relation_mm) {
  constexpr double kClassOne_mm = 1.75;
  if (std::isnan(relation_mm)) return "";
  if (std::abs(relation_mm) <= kClassOne_mm) return "I";
  return relation_mm < 0.0 ? "II" : "III";
}

std::optional<Vec3> dental_midline(const NumberedCrowns& crowns_L, bool is_upper) {
  const Crown* const right = crown_of(crowns_L, is_upper ? 11 : 41);
  const Crown* const left = crown_of(crowns_L, is_upper ? 21 : 31);
  if (right == nullptr || left == nullptr) return std::nullopt;
  return Vec3(0.5 * (right->center_L + left->center_L));
}

OcclusalRelations occlusal_relations(const NumberedCrowns& crowns_L,
                                     const RigidTransform& X_L_lower, const ArchAxes& axes) {
  const auto upper = dental_midline(crowns_L, true), lower = dental_midline(crowns_L, false);
  return {upper && lower ? (X_L_lower * *lower - *upper).dot(axes.left_L()) : kUnknown,
          canine_relation(crowns_L, 13, 43, X_L_lower),
          canine_relation(crowns_L, 23, 33, X_L_lower), molar_relation(crowns_L, 16, 46, X_L_lower),
          molar_relation(crowns_L, 26, 36, X_L_lower)};
}

}  // namespace lefort::dental
