#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/report/internal/surface_raster.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lefort::report {

namespace {

/// Twice the smallest area of a triangle that covers samples, in squares between samples.
constexpr double kMinArea = 1e-9;

/// Twice the signed area of an edge and a point (Pineda 1988), linear in the point. Both triangles
/// of an edge compute it from the lower vertex number, so that their values are exactly opposite.
struct EdgeFunction {
  double x0, y0, dx, dy, sign;

  EdgeFunction(const std::vector<Vec3>& points, std::int32_t from, std::int32_t to)
      : sign(from < to ? 1.0 : -1.0) {
    if (from > to) std::swap(from, to);
    const Vec3 &a = points[std::size_t(from)], &b = points[std::size_t(to)];
    x0 = a.x();
    y0 = a.y();
    dx = b.x() - a.x();
    dy = b.y() - a.y();
  }
  /// The value at (x, y) is along_row(y) - slope() * (x - x0).
  [[nodiscard]] double along_row(double y) const { return sign * dx * (y - y0); }
  [[nodiscard]] double slope() const { return sign * dy; }
};

/// Samples whose centers lie in [low, high], limited to [first, last]; or one more at an end.
std::pair<int, int> samples_in(double low, double high, int first, int last) {
  return {int(std::clamp(low - 0.5, double(first), double(last) + 1.0)),
          int(std::clamp(high, double(first) - 1.0, double(last)))};
}

}  // namespace

SurfaceRaster::SurfaceRaster(const geometry::TriangleMesh& mesh_L, const SampleGrid& grid,
                             int band_rows)
    : mesh_L_(mesh_L), columns_(grid.columns), rows_(grid.rows), band_rows_(band_rows) {
  LEFORT_CHECK(grid.columns >= 1 && grid.rows >= 1 && band_rows >= 1 && grid.mm_per_sample > 0.0);
  projected_.resize(mesh_L.vertices.size());
  parallel_for(mesh_L.vertex_count(), [&](Index v) {
    const Vec3 from_center_L = mesh_L.vertices[std::size_t(v)] - grid.center_L;
    projected_[std::size_t(v)] =
        Vec3(0.5 * columns_ + grid.camera.right_L.dot(from_center_L) / grid.mm_per_sample,
             0.5 * rows_ - grid.camera.up_L.dot(from_center_L) / grid.mm_per_sample,
             -grid.camera.towards_L.dot(from_center_L));
  });
  const int bands = (rows_ + band_rows_ - 1) / band_rows_;
  const auto for_each_band = [&](std::size_t t, const auto& visit) {
    const auto y = [&](std::size_t c) {
      return projected_[std::size_t(mesh_L.triangles[t][c])].y();
    };
    const auto [low, high] = std::minmax({y(0), y(1), y(2)});
    const auto [first, last] = samples_in(low, high, 0, rows_ - 1);
    if (first > last) return;
    for (int band = first / band_rows_; band <= last / band_rows_; ++band) visit(std::size_t(band));
  };
  first_.assign(std::size_t(bands) + 1, 0);
  for (std::size_t t = 0; t < mesh_L.triangles.size(); ++t)
    for_each_band(t, [&](std::size_t band) { ++first_[band + 1]; });
  for (std::size_t band = 0; band < std::size_t(bands); ++band) first_[band + 1] += first_[band];
  sorted_.resize(first_.back());
  std::vector<std::size_t> next(first_);
  for (std::size_t t = 0; t < mesh_L.triangles.size(); ++t)
    for_each_band(t, [&](std::size_t band) { sorted_[next[band]++] = std::uint32_t(t); });
}

void SurfaceRaster::rasterize(int band, std::vector<RasterHit>& hits) const {
  hits.assign(std::size_t(columns_) * std::size_t(band_rows_), RasterHit{});
  const int first_row = band * band_rows_;
  const int last_row = std::min(rows_, first_row + band_rows_) - 1;
  for (std::size_t n = first_[std::size_t(band)]; n < first_[std::size_t(band) + 1]; ++n)
    draw(sorted_[n], first_row, last_row, hits);
}

void SurfaceRaster::draw(std::uint32_t triangle, int first_row, int last_row,
                         std::vector<RasterHit>& hits) const {
  const geometry::Triangle& t = mesh_L_.triangles[triangle];
  const Vec3 &a = projected_[std::size_t(t[0])], &b = projected_[std::size_t(t[1])],
             &c = projected_[std::size_t(t[2])];
  const auto [left, right] =
      samples_in(std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}), 0, columns_ - 1);
  const auto [top, bottom] = samples_in(std::min({a.y(), b.y(), c.y()}),
                                        std::max({a.y(), b.y(), c.y()}), first_row, last_row);
  if (left > right || top > bottom) return;
  const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  if (!(std::abs(area) > kMinArea)) return;  // Seen from its side.
  const double side = area > 0.0 ? 1.0 : -1.0, inverse = 1.0 / std::abs(area);
  const EdgeFunction opposite_a(projected_, t[1], t[2]), opposite_b(projected_, t[2], t[0]),
      opposite_c(projected_, t[0], t[1]);
  const double slope_a = side * opposite_a.slope(), slope_b = side * opposite_b.slope(),
               slope_c = side * opposite_c.slope();
  for (int row = top; row <= bottom; ++row) {
    RasterHit* const line = hits.data() + std::size_t(row - first_row) * std::size_t(columns_);
    const double y = row + 0.5;
    const double row_a = side * opposite_a.along_row(y), row_b = side * opposite_b.along_row(y),
                 row_c = side * opposite_c.along_row(y);
    for (int column = left; column <= right; ++column) {
      const double x = column + 0.5;
      const double w_a = row_a - slope_a * (x - opposite_a.x0),
                   w_b = row_b - slope_b * (x - opposite_b.x0),
                   w_c = row_c - slope_c * (x - opposite_c.x0);
      if (std::min({w_a, w_b, w_c}) < 0.0) continue;
      const auto depth = float((w_a * a.z() + w_b * b.z() + w_c * c.z()) * inverse);
      if (depth < line[column].depth_mm)
        line[column] = {triangle, float(w_b * inverse), float(w_c * inverse), depth};
    }
  }
}

}  // namespace lefort::report
