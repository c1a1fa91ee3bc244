#include <lefort/core/parallel.h>
#include <lefort/image/interpolate.h>
#include <lefort/image/radiograph.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace lefort::image {
namespace {

constexpr double kAir_hu = -1000.0;

/// The part of a line within the voxels; empty (first > second) if it misses them.
std::pair<double, double> within(const Grid& grid, const Vec3& from_L, const Vec3& along_L) {
  const Vec3 from_V = grid.index_V(from_L);
  const Vec3 along_V = (grid.direction.transpose() * along_L).cwiseQuotient(grid.spacing_mm);
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (int axis = 0; axis < 3; ++axis) {
    const double last = double(grid.size[std::size_t(axis)]) - 0.5;
    if (along_V[axis] == 0.0) {
      if (from_V[axis] < -0.5 || from_V[axis] > last) return {1.0, 0.0};
      continue;
    }
    const double a = (-0.5 - from_V[axis]) / along_V[axis],
                 b = (last - from_V[axis]) / along_V[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return {enter, leave};
}

double integral(const CtVolume& ct, const Vec3& from_L, const Vec3& along_L, double step_mm) {
  const auto [enter, leave] = within(ct.grid, from_L, along_L);
  if (!(enter < leave)) return 0.0;
  const auto steps = Index(std::ceil((leave - enter) / step_mm));
  const double h = (leave - enter) / double(steps);
  double sum = 0.0;
  for (Index n = 0; n < steps; ++n) {
    const double t = enter + h * (double(n) + 0.5);
    sum += std::max(0.0, 1.0 + interpolate(ct, from_L + t * along_L, kAir_hu) / 1000.0);
  }
  return sum * h;
}

}  // namespace

std::vector<double> radiograph(const CtVolume& ct, const RadiographView& view, double step_mm) {
  const Vec3 away_L = view.right_L.cross(view.down_L);
  std::vector<double> water_mm(std::size_t(view.columns) * std::size_t(view.rows));
  parallel_for(
      Index(view.rows),
      [&](Index row) {
        for (int column = 0; column < view.columns; ++column) {
          const double x = view.pixel_mm * (double(column) + 0.5 - 0.5 * double(view.columns));
          const double y = view.pixel_mm * (double(row) + 0.5 - 0.5 * double(view.rows));
          const Vec3 p_L = view.center_L + x * view.right_L + y * view.down_L;
          Vec3 along_L = away_L;
          if (view.source_mm)
            along_L = (p_L - (view.center_L - *view.source_mm * away_L)).normalized();
          water_mm[std::size_t(row) * std::size_t(view.columns) + std::size_t(column)] =
              integral(ct, p_L, along_L, step_mm);
        }
      },
      4);
  return water_mm;
}

}  // namespace lefort::image
