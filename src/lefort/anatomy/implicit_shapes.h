/// \file
/// Level-set functions of simple bodies, positive inside, exact to first order at their surface.
#pragma once

#include <lefort/core/types.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace lefort::anatomy::implicit {

[[nodiscard]] inline double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 q = (p - center).cwiseQuotient(radii);
  const double k = q.norm(), slope = q.cwiseQuotient(radii).norm();
  return slope < 1e-9 ? radii.minCoeff() : k * (1.0 - k) / slope;
}

/// Between two spheres, with linearly interpolated radius.
[[nodiscard]] inline double cone(const Vec3& p, const Vec3& a, const Vec3& b, double radius_a,
                                 double radius_b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return radius_a + t * (radius_b - radius_a) - (p - a - t * (b - a)).norm();
}

/// Around a polyline.
[[nodiscard]] inline double tube(const Vec3& p, std::initializer_list<Vec3> points, double radius) {
  double inside = -1e9;
  for (const Vec3* b = points.begin() + 1; b != points.end(); ++b)
    inside = std::max(inside, cone(p, *(b - 1), *b, radius, radius));
  return inside;
}

/// Box with rounded edges; `half` includes the rounding.
[[nodiscard]] inline double rounded_box(const Vec3& p, const Vec3& center, const Vec3& half,
                                        double radius) {
  const Vec3 d = (p - center).cwiseAbs() - (half - Vec3::Constant(radius));
  return radius - d.cwiseMax(0.0).norm() - std::min(d.maxCoeff(), 0.0);
}

/// Union with a fillet of about `width` (Quilez's polynomial minimum).
[[nodiscard]] inline double join(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::max(a, b) + 0.25 * h * h * width;
}

/// Difference with rounded edges.
[[nodiscard]] inline double without(double a, double b, double width) {
  return -join(-a, b, width);
}

}  // namespace lefort::anatomy::implicit
