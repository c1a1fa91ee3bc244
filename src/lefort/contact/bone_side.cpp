#include <lefort/contact/bone_side.h>
#include <lefort/core/check.h>

namespace lefort::contact {
namespace {

/// Of the nearest surface along the normal that was seen, both of length one: below, it is another
/// surface; above, the same again. In the middle of thin bone a sampled gradient is short, too.
constexpr double kTurned = 0.5, kAgrees = 0.7;

/// Likewise: off the bone, but on its far side. An edge of less than 60 degrees has two.
constexpr double kFarSide = -0.5;

double cosine(const BoneObstacle& obstacle, const Gap& gap, const Sight& last) {
  return (obstacle.X_LB.linear() * last.normal_B).dot(gap.gradient_L);
}

}  // namespace

Sight look(const BoneObstacle& obstacle, const Vec3& p_L, const Gap& gap) {
  Sight sight{.knows_side = gap.zone != field::Zone::kUnknown};
  const double length = gap.gradient_L.norm();
  if (gap.zone != field::Zone::kBand || !(length > 0.0)) return sight;
  const Mat3 R_BL = obstacle.X_LB.linear().transpose();
  sight.normal_B = R_BL * (gap.gradient_L / length);
  sight.foot_B = R_BL * (p_L - obstacle.X_LB.translation()) - gap.gap_mm * sight.normal_B;
  return sight;
}

Gap gap_to_wall(const BoneObstacle& obstacle, const Vec3& p_L, const Sight& last) {
  LEFORT_ASSERT(last.has_wall());
  const Vec3 normal_L = obstacle.X_LB.linear() * last.normal_B;
  return {.zone = field::Zone::kBand,
          .gap_mm = normal_L.dot(p_L - obstacle.X_LB * last.foot_B),
          .gradient_L = normal_L};
}

bool is_past_middle(const BoneObstacle& obstacle, const Vec3& p_L, const Gap& gap,
                    const Sight& last) {
  return gap.zone == field::Zone::kBand && gap.gap_mm < 0.0 && last.has_wall() &&
         cosine(obstacle, gap, last) < kTurned &&
         gap_to_wall(obstacle, p_L, last).gap_mm < gap.gap_mm;
}

bool sees_its_side(const BoneObstacle& obstacle, const Vec3& p_L, const Gap& gap,
                   const Sight& last) {
  if (gap.zone != field::Zone::kBand) return true;
  const double along = cosine(obstacle, gap, last);
  return along > kAgrees || (gap.gap_mm >= 0.0 && along > kFarSide) ||
         gap_to_wall(obstacle, p_L, last).gap_mm >= gap.gap_mm;
}

}  // namespace lefort::contact
