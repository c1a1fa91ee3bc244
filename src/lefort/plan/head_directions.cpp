#include <lefort/core/units.h>
#include <lefort/plan/head_directions.h>

#include <algorithm>
#include <cmath>

namespace lefort::plan {

Result<HeadDirections> head_directions(std::span<const Landmark> landmarks) {
  HeadDirections head;
  LEFORT_TRY(head.left_L, patient_left_axis(landmarks));
  const auto orbitale_L = pair_midpoint(landmarks, "Or"), porion_L = pair_midpoint(landmarks, "Po");
  head.has_frankfurt_horizontal = orbitale_L && porion_L;
  Vec3 anterior_L = head.has_frankfurt_horizontal ? Vec3(*orbitale_L - *porion_L)
                                                  : Vec3(head.left_L.cross(Vec3::UnitZ()));
  anterior_L -= head.left_L.dot(anterior_L) * head.left_L;
  constexpr double kMinLength_mm = 20.0, kMinCosine = 0.5;
  if (head.has_frankfurt_horizontal &&
      (anterior_L.norm() < kMinLength_mm || -anterior_L.y() < kMinCosine * anterior_L.norm()))
    return fail(ErrorCode::kPlanInvalid,
                "orbitale (Or) is not anterior to porion (Po): the landmarks are exchanged, or on "
                "each other");
  head.anterior_L = anterior_L.normalized();
  head.superior_L = head.anterior_L.cross(head.left_L);
  return head;
}

MovementTerms movement_terms(const RigidTransform& X_LB, const Vec3& at_L,
                             const HeadDirections& directions) {
  const Vec3 shift = X_LB * at_L - at_L;
  Mat3 R_LF;
  R_LF << directions.anterior_L, directions.left_L, directions.superior_L;
  const Mat3 R = R_LF.transpose() * X_LB.linear() * R_LF;
  MovementTerms terms;
  terms.anterior_mm = shift.dot(directions.anterior_L);
  terms.left_mm = shift.dot(directions.left_L);
  terms.superior_mm = shift.dot(directions.superior_L);
  terms.yaw_deg = degrees_from_radians(std::atan2(R(1, 0), R(0, 0)));
  terms.pitch_deg = degrees_from_radians(std::asin(std::clamp(-R(2, 0), -1.0, 1.0)));
  terms.roll_deg = degrees_from_radians(std::atan2(R(2, 1), R(2, 2)));
  return terms;
}

}  // namespace lefort::plan
