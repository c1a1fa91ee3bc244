#include <lefort/core/parallel.h>
#include <lefort/field/sign/edge_function_yz.h>
#include <lefort/field/sign/winding_scanlines.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lefort::field {

namespace {

/// There is a line for every second row of points along y and along z.
constexpr int kSpacing = 2;
/// Offset of the lines from those rows, in cells: about half of the spacing, with fractions that no
/// surface coincides with.
constexpr double kOffset_y = 0.47140452079103, kOffset_z = 0.53033008588991;
constexpr bool near_all_rows(double offset_y, double offset_z) {
  const double y = std::max(offset_y, kSpacing - 1 - offset_y),
               z = std::max(offset_z, kSpacing - 1 - offset_z);
  return y * y + z * z < 1.0;
}
static_assert(near_all_rows(kOffset_y, kOffset_z), "results are for points further than a cell");
constexpr Index kRowsPerTask = 2048;

int lines_per_side(int resolution) { return resolution / kSpacing + 1; }

struct Hit {
  std::uint32_t line;
  float x;
  std::int32_t winding;
};

/// Finds the lines that cross a triangle with corners in cells.
void find_hits(const std::array<Vec3, 3>& corner, int lines, std::vector<Hit>& hits) {
  const auto range = [&](int axis, double offset) {
    const auto [minimum, maximum] =
        std::minmax({corner[0][axis], corner[1][axis], corner[2][axis]});
    // From the first line not below the triangle to the last one not above it; line numbers are not
    // negative, so truncation rounds down.
    const double from = (minimum - offset) / kSpacing, to = (maximum - offset) / kSpacing;
    return std::pair(std::max(0, int(from) + (double(int(from)) < from ? 1 : 0)),
                     std::min(lines - 1, int(to)));
  };
  const auto [y_low, y_high] = range(1, kOffset_y);
  const auto [z_low, z_high] = range(2, kOffset_z);
  if (y_low > y_high || z_low > z_high) return;
  const EdgeFunctionYz opposite_0(corner[1], corner[2]), opposite_1(corner[2], corner[0]),
      opposite_2(corner[0], corner[1]);
  for (int z = z_low; z <= z_high; ++z)
    for (int y = y_low; y <= y_high; ++y) {
      const double py = kSpacing * y + kOffset_y, pz = kSpacing * z + kOffset_z;
      const double a = opposite_0.evaluate(py, pz), b = opposite_1.evaluate(py, pz),
                   c = opposite_2.evaluate(py, pz);
      const bool all_left = a > 0.0 && b > 0.0 && c > 0.0;
      const bool all_right = a < 0.0 && b < 0.0 && c < 0.0;
      if (!all_left && !all_right) continue;
      const double x = (a * corner[0].x() + b * corner[1].x() + c * corner[2].x()) / (a + b + c);
      // In the plane of y and z a triangle with a normal of positive x is counter-clockwise: there
      // a line along +x leaves the volume.
      hits.push_back({std::uint32_t(z * lines + y), float(x), all_right ? 1 : -1});
    }
}

}  // namespace

WindingScanlines::WindingScanlines(const geometry::TriangleMesh& mesh_B, const FieldFrame& frame)
    : resolution_(frame.resolution) {
  const int side = lines_per_side(resolution_);
  const double cells_per_mm = 1.0 / frame.cell_mm;
  const auto blocks = std::size_t((mesh_B.triangle_count() + kRowsPerTask - 1) / kRowsPerTask);
  std::vector<std::vector<Hit>> hits(blocks);
  const auto to_cells = [&](const Vec3& p_B) -> Vec3 {
    return (p_B - frame.origin_B) * cells_per_mm;
  };
  parallel_for_blocks(
      mesh_B.triangle_count(),
      [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t)
          find_hits({to_cells(mesh_B.corner(t, 0)), to_cells(mesh_B.corner(t, 1)),
                     to_cells(mesh_B.corner(t, 2))},
                    side, hits[std::size_t(begin / kRowsPerTask)]);
      },
      kRowsPerTask);

  const auto lines = std::size_t(side) * std::size_t(side);
  first_.assign(lines + 1, 0);
  for (const auto& list : hits)
    for (const Hit& hit : list) ++first_[hit.line + 1];
  for (std::size_t line = 0; line < lines; ++line) first_[line + 1] += first_[line];
  crossings_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const auto& list : hits)
    for (const Hit& hit : list) crossings_[next[hit.line]++] = {hit.x, hit.winding};
  parallel_for(
      Index(lines),
      [&](Index line) {
        std::sort(crossings_.begin() + first_[std::size_t(line)],
                  crossings_.begin() + first_[std::size_t(line) + 1],
                  [](const Crossing& a, const Crossing& b) {
                    return a.x != b.x ? a.x < b.x : a.winding < b.winding;
                  });
      },
      4096);
}

bool WindingScanlines::is_inside(const LatticePoint& point) const {
  for (const int c : point)
    if (c < 0 || c > resolution_) return false;  // The surface is inside the cube.
  const auto line = std::size_t(point[2] / kSpacing) * std::size_t(lines_per_side(resolution_)) +
                    std::size_t(point[1] / kSpacing);
  std::int32_t winding = 0;
  for (std::uint32_t i = first_[line]; i < first_[line + 1] && crossings_[i].x < float(point[0]);
       ++i)
    winding += crossings_[i].winding;
  return winding > 0;
}

}  // namespace lefort::field
