#include <lefort/contact/thin_bone_contact.h>
#include <lefort/core/check.h>

namespace lefort::contact {
namespace {

/// Cosines between the closest normal and the reference normal: below the first the closest surface
/// is another one (60 degrees), above the second it is the same one again (45 degrees). Near the
/// medial surface a sampled gradient is short, which lowers the cosine, too. Tests of
/// ThinBoneContact cover both sides of each.
constexpr double kOtherSurface = 0.5;
constexpr double kSameSurface = 0.7;

/// Below this cosine the closest surface is on the far side (120 degrees). Only an edge sharper
/// than 60 degrees has two surfaces that differ so much.
constexpr double kFarSide = -0.5;

double cosine_to_reference(const RigidObstacle& obstacle, const Gap& gap,
                           const ContactReference& last) {
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
         cosine_to_reference(obstacle, gap, last) < kOtherSurface &&
         gap_to_tangent_plane(obstacle, p_L, last).gap_mm < gap.gap_mm;
}

bool has_returned(const RigidObstacle& obstacle, const Vec3& p_L, const Gap& gap,
                  const ContactReference& last) {
  if (gap.zone != field::Zone::kBand) return true;
  const double cosine = cosine_to_reference(obstacle, gap, last);
  return cosine > kSameSurface || (gap.gap_mm >= 0.0 && cosine > kFarSide) ||
         gap_to_tangent_plane(obstacle, p_L, last).gap_mm >= gap.gap_mm;
}

bool is_at_far_side(const RigidObstacle& obstacle, const Gap& gap, const ContactReference& last) {
  return gap.zone == field::Zone::kBand && gap.gap_mm < 0.0 &&
         cosine_to_reference(obstacle, gap, last) < kFarSide;
}

}  // namespace lefort::contact
