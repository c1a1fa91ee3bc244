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
