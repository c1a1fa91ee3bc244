#include <lefort/geometry/motion_rates.h>

#include <cmath>

namespace lefort::geometry {

std::array<MotionRate, 6> motion_rates(const Vec3& translation_mm, const Vec3& rotation_rad,
                                       const Vec3& center_L) {
  constexpr double kSmall = 1e-2;  // Below this angle the series are exact to round-off.
  const double a = rotation_rad.norm(), a2 = a * a;
  Mat3 cross;
  cross << 0.0, -rotation_rad.z(), rotation_rad.y(), rotation_rad.z(), 0.0, -rotation_rad.x(),
      -rotation_rad.y(), rotation_rad.x(), 0.0;
  const double sine = std::sin(0.5 * a);
  const double first = a < kSmall ? 0.5 - a2 / 24.0 + a2 * a2 / 720.0 : 2.0 * sine * sine / a2;
  const double second =
      a < kSmall ? 1.0 / 6.0 - a2 / 120.0 + a2 * a2 / 5040.0 : (a - std::sin(a)) / (a2 * a);
  const Mat3 left_jacobian = Mat3::Identity() + first * cross + second * cross * cross;
  std::array<MotionRate, 6> rates;
  for (Index i = 0; i < 3; ++i) {
    rates[std::size_t(i)].translation = Vec3::Unit(i);
    rates[std::size_t(i) + 3] = {.translation = Vec3::Zero(),
                                 .rotation_rad = left_jacobian.col(i),
                                 .at_L = center_L + translation_mm};
  }
  return rates;
}

}  // namespace lefort::geometry
