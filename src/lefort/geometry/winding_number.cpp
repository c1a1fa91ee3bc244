#include <lefort/geometry/winding_number.h>

#include <cmath>
#include <numbers>

namespace lefort::geometry {

double winding_number(const TriangleMesh& surface, const Vec3& p) {
  double solid_angle = 0.0;
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    const Vec3 a = surface.corner(t, 0) - p;
    const Vec3 b = surface.corner(t, 1) - p;
    const Vec3 c = surface.corner(t, 2) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    solid_angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                                    la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return solid_angle / (4.0 * std::numbers::pi);
}

}  // namespace lefort::geometry
