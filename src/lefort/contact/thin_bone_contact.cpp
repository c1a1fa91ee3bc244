#include <lefort/contact/thin_bone_contact.h>
#include <lefort/core/check.h>

namespace lefort::contact {
namespace {

/// Of the nearest surface along the normal that was seen, both of length one: below, it is another
/// surface; above, the same again. In the middle of thin bone a sampled gradient is short, too.
constexpr double kTurned = 0.5, kAgrees = 0.7;

/// Likewise: off the bone, but on its far side. An edge of less than 60 degrees has two.
constexpr double kFarSide = -0.5;

double cosine(const RigidObstacle& obstacle, const Gap& gap, const ContactReference& last) {
  return (obstacle.X_LB.linear() * last.normal_B).dot(gap.gradient_L);
}

}  // namespace

ContactReference contact_reference(const RigidObstacle& obstacle, const Vec3& p_L, const Gap& gap) {
  ContactReference reference{.is_side_known = gap.zone != field::Zone::kUnknown};
  const double length = gap.gradient_L.norm();
  if (gap.zone != field::Zone::kBand || !(length > 0.0)) return reference;
  const Mat3 R_BL = obstacle.X_LB.linear().transpose();
  reference.normal_B = R_BL * (gap.gradient_L / length);
  reference.foot_B = R_BL * (p_L - obstacle.X_LB.translation()) - gap.gap_mm * reference.normal_B;
  return reference;
}

Gap gap_to_tangent_plane(const RigidObstacle& obstacle, const Vec3& p_L,
                         const ContactReference& last) {
  LEFORT_ASSERT(last.has_tangent_plane());
  const Vec3 normal_L = obstacle.X_LB.linear() * last.normal_B;
  return {.zone = field::Zone::kBand,
          .gap_mm = normal_L.dot(p_L - obstacle.X_LB * last.foot_B),
          .gradient_L = normal_L};
}

bool has_crossed_medial_surface(const RigidObstacle& obstacle, const Vec3& p_L, const Gap& gap,
                                const ContactReference& last) {
  return gap.zone == field::Zone::kBand && gap.gap_mm < 0.0 && last.has_tangent_plane() &&
         cosine(obstacle, gap, last) < kTurned &&
         gap_to_tangent_plane(obstacle, p_L, last).gap_mm < gap.gap_mm;
}

bool has_returned(const RigidObstacle& obstacle, const Vec3& p_L, const Gap& gap,
                  const ContactReference& last) {
  if (gap.zone != field::Zone::kBand) return true;
  const double along = cosine(obstacle, gap, last);
  return along > kAgrees || (gap.gap_mm >= 0.0 && along > kFarSide) ||
         gap_to_tangent_plane(obstacle, p_L, last).gap_mm >= gap.gap_mm;
}

}  // namespace lefort::contact
