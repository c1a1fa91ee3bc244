#include <lefort/contact/rest_gap.h>

#include <algorithm>
#include <cmath>

namespace lefort::contact {

Gap gap_to_bone(const RigidObstacle& obstacle, const Vec3& p_L, const Gap& to_obstacle) {
  if (!obstacle.bone_B) return to_obstacle;
  return measure_gap({obstacle.bone_B, obstacle.X_LB, nullptr}, p_L, Derivatives::kFirst);
}

double rest_gap_mm(const Gap& to_obstacle, const Gap& to_bone, double contact_snap_mm) {
  const bool touches =
      to_bone.zone == field::Zone::kBand && std::abs(to_bone.gap_mm) <= contact_snap_mm;
  const double clearance_mm = touches ? 0.0 : std::max(to_bone.gap_mm, 0.0);
  const bool is_known =
      to_obstacle.zone == field::Zone::kBand && (touches || to_bone.zone == field::Zone::kBand);
  return is_known ? to_obstacle.gap_mm - clearance_mm : std::min(to_obstacle.gap_mm, 0.0);
}

double bone_rest_gap_mm(const Gap& to_bone, double contact_snap_mm) {
  return rest_gap_mm(to_bone, to_bone, contact_snap_mm);
}

double bone_depth_mm(const RigidObstacle& obstacle, const Vec3& p_L, const Gap& to_obstacle,
                     double bone_rest_gap_mm) {
  const Gap to_bone = gap_to_bone(obstacle, p_L, to_obstacle);
  return to_bone.zone == field::Zone::kOutside ? 0.0 : bone_rest_gap_mm - to_bone.gap_mm;
}

}  // namespace lefort::contact
