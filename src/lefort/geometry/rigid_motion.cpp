#include <lefort/geometry/rigid_motion.h>

#include <cmath>

namespace lefort::geometry {

RigidTransform rigid_motion(const Vec3& translation_mm, const Vec3& rotation_rad,
                            const Vec3& center_L) {
  RigidTransform X_LB = RigidTransform::Identity();
  const double angle_rad = rotation_rad.norm();
  if (angle_rad > 0.0)
    X_LB.linear() = Eigen::AngleAxisd(angle_rad, rotation_rad / angle_rad).toRotationMatrix();
  X_LB.translation() = center_L + translation_mm - X_LB.linear() * center_L;
  return X_LB;
}

std::array<MotionRate, 6> motion_rates(const Vec3& translation_mm, const Vec3& rotation_rad,
                                       const Vec3& center_L) {
  constexpr double kSmall = 1e-4;  // Below this angle the next term of the series is round-off.
  const double a = rotation_rad.norm();
  Mat3 cross;
  cross << 0.0, -rotation_rad.z(), rotation_rad.y(), rotation_rad.z(), 0.0, -rotation_rad.x(),
      -rotation_rad.y(), rotation_rad.x(), 0.0;
  const double sine = std::sin(0.5 * a);
  const double first = a < kSmall ? 0.5 - a * a / 24.0 : 2.0 * sine * sine / (a * a);
  const double second = a < kSmall ? 1.0 / 6.0 : (a - std::sin(a)) / (a * a * a);
  const Mat3 left_jacobian = Mat3::Identity() + first * cross + second * cross * cross;
  std::array<MotionRate, 6> rates;
  for (Index i = 0; i < 3; ++i) {
    rates[std::size_t(i)].translation = Vec3::Unit(i);
    rates[std::size_t(i) + 3] = {.rotation_rad = left_jacobian.col(i),
                                 .at_L = center_L + translation_mm};
  }
  return rates;
}

Vec3 rotation_vector(const Mat3& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0)
    q.coeffs() = -q.coeffs();  // Both represent the rotation; this one has the smaller angle.
  // Uses the sine of half the angle: accurate for small angles, unlike the arc cosine of w.
  const double sine = q.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

RigidTransform interpolate_pose(const RigidTransform& from_LB, const RigidTransform& to_LB,
                                double fraction, const Vec3& center_B) {
  const Vec3 start_L = from_LB * center_B;
  const Vec3 end_L = to_LB * center_B;
  const Vec3 turn_rad = rotation_vector(to_LB.linear() * from_LB.linear().transpose());
  return rigid_motion(fraction * (end_L - start_L), fraction * turn_rad, start_L) * from_LB;
}

RigidTransform interpolate_screw(const RigidTransform& from_LB, const RigidTransform& to_LB,
                                 double fraction) {
  const Vec3 turn_rad = rotation_vector(to_LB.linear() * from_LB.linear().transpose());
  const double angle_rad = turn_rad.norm();
  const Vec3 shift = (to_LB * from_LB.inverse()).translation();
  if (angle_rad == 0.0) return rigid_motion(fraction * shift, Vec3::Zero(), Vec3::Zero()) * from_LB;
  // Computed from chords of the circle about the axis, so the axis may be arbitrarily far away.
  const Vec3 axis = turn_rad / angle_rad;
  const Vec3 glide = axis.dot(shift) * axis;
  const double chord = std::sin(0.5 * fraction * angle_rad) / std::sin(0.5 * angle_rad);
  const Mat3 lag = Eigen::AngleAxisd(0.5 * (fraction - 1.0) * angle_rad, axis).toRotationMatrix();
  const Vec3 shift_now = fraction * glide + chord * (lag * (shift - glide));
  return rigid_motion(shift_now, fraction * turn_rad, Vec3::Zero()) * from_LB;
}

}  // namespace lefort::geometry
