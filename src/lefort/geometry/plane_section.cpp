#include <lefort/core/check.h>
#include <lefort/geometry/plane_section.h>

namespace lefort::geometry {

std::vector<std::array<Vec3, 2>> plane_section(const TriangleMesh& mesh, int axis, double at_mm) {
  LEFORT_CHECK(axis >= 0 && axis < 3);
  std::vector<std::array<Vec3, 2>> pieces;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    std::array<Vec3, 2> ends;
    std::size_t found = 0;
    for (int side = 0; side < 3; ++side) {
      const Vec3 &a = mesh.corner(t, side), &b = mesh.corner(t, (side + 1) % 3);
      const bool above = a[axis] >= at_mm;
      if (above == (b[axis] >= at_mm)) continue;
      // From above to below, so that both triangles of an edge compute the same point.
      const Vec3 &high = above ? a : b, &low = above ? b : a;
      Vec3 end = high + (high[axis] - at_mm) / (high[axis] - low[axis]) * (low - high);
      end[axis] = at_mm;
      ends.at(found++) = end;
    }
    if (found == 2) pieces.push_back(ends);
  }
  return pieces;
}

}  // namespace lefort::geometry
