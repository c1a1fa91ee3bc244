#include <lefort/core/check.h>
#include <lefort/geometry/surface_crossings.h>

#include <algorithm>
#include <cmath>

namespace lefort::geometry {
namespace {

/// Pixels are offset by a fraction without a short binary form: no line meets a vertex of a surface
/// that lies on the grid of a scan.
constexpr double kOffset = 0.5128205;

}  // namespace

SurfaceCrossings::SurfaceCrossings(const TriangleMesh& mesh, int axis, const Box3& window,
                                   double pixel_mm)
    : axis_(axis),
      across_((axis + 1) % 3),
      along_((axis + 2) % 3),
      window_(window),
      pixel_mm_(pixel_mm),
      columns_(0),
      rows_(0) {
  LEFORT_CHECK(axis >= 0 && axis < 3 && pixel_mm > 0.0 && !window.isEmpty());
  columns_ = Index(window.sizes()[across_] / pixel_mm) + 1;
  rows_ = Index(window.sizes()[along_] / pixel_mm) + 1;
  std::vector<std::pair<Index, double>> found;
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    visit_triangle(mesh, t, [&](Index line, double at) { found.emplace_back(line, at); });
  std::sort(found.begin(), found.end());
  begin_.assign(std::size_t(columns_ * rows_) + 1, 0);
  for (const auto& [line, at] : found) {
    ++begin_[std::size_t(line) + 1];
    crossings_.push_back(at);
  }
  for (std::size_t line = 1; line < begin_.size(); ++line) begin_[line] += begin_[line - 1];
}

template <class OnCrossing>
void SurfaceCrossings::visit_triangle(const TriangleMesh& mesh, Index triangle,
                                      const OnCrossing& on_crossing) const {
  std::array<Eigen::Vector2d, 3> at;
  for (int c = 0; c < 3; ++c) {
    const Vec3 p = mesh.corner(triangle, c) - window_.min();
    at[std::size_t(c)] = Eigen::Vector2d(p[across_], p[along_]) / pixel_mm_;
    at[std::size_t(c)].array() -= kOffset;
  }
  const Eigen::Vector2d low = at[0].cwiseMin(at[1]).cwiseMin(at[2]);
  const Eigen::Vector2d high = at[0].cwiseMax(at[1]).cwiseMax(at[2]);
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  const double area = cross(at[1] - at[0], at[2] - at[0]);
  if (area == 0.0) return;
  const Index first_column = std::max<Index>(0, Index(std::ceil(low.x())));
  const Index last_column = std::min(columns_ - 1, Index(std::floor(high.x())));
  const Index first_row = std::max<Index>(0, Index(std::ceil(low.y())));
  const Index last_row = std::min(rows_ - 1, Index(std::floor(high.y())));
  for (Index row = first_row; row <= last_row; ++row)
    for (Index column = first_column; column <= last_column; ++column) {
      const Eigen::Vector2d q{double(column), double(row)};
      Vec3 weight;
      for (int c = 0; c < 3; ++c)
        weight[c] =
            cross(at[std::size_t((c + 1) % 3)] - q, at[std::size_t((c + 2) % 3)] - q) / area;
      if (weight.minCoeff() < 0.0) continue;
      double coordinate = 0.0;
      for (int c = 0; c < 3; ++c) coordinate += weight[c] * mesh.corner(triangle, c)[axis_];
      if (coordinate >= window_.min()[axis_] && coordinate <= window_.max()[axis_])
        on_crossing(column + columns_ * row, coordinate);
    }
}

std::optional<Index> SurfaceCrossings::line_at(const Vec3& p) const {
  const Vec3 q = (p - window_.min()) / pixel_mm_;
  const Index column = Index(std::floor(q[across_])), row = Index(std::floor(q[along_]));
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return std::nullopt;
  return column + columns_ * row;
}

Vec3 SurfaceCrossings::point_of(Index line, double coordinate) const {
  Vec3 p = window_.min();
  p[axis_] = coordinate;
  p[across_] += (double(line % columns_) + kOffset) * pixel_mm_;
  p[along_] += (double(line / columns_) + kOffset) * pixel_mm_;
  return p;
}

std::span<const double> SurfaceCrossings::crossings(const Vec3& p) const {
  const auto line = line_at(p);
  if (!line) return {};
  const auto begin = std::size_t(begin_[std::size_t(*line)]);
  return std::span(crossings_).subspan(begin, std::size_t(begin_[std::size_t(*line) + 1]) - begin);
}

std::optional<Vec3> SurfaceCrossings::first(const Vec3& p) const {
  const auto all = crossings(p);
  if (all.empty()) return std::nullopt;
  return point_of(*line_at(p), all.front());
}

std::optional<Vec3> SurfaceCrossings::last(const Vec3& p) const {
  const auto all = crossings(p);
  if (all.empty()) return std::nullopt;
  return point_of(*line_at(p), all.back());
}

std::vector<Vec3> SurfaceCrossings::within(const Box3& box, bool is_first) const {
  std::vector<Vec3> found;
  for (Index line = 0; line < columns_ * rows_; ++line) {
    const Index begin = begin_[std::size_t(line)], end = begin_[std::size_t(line) + 1];
    if (begin == end) continue;
    const Vec3 p = point_of(line, crossings_[std::size_t(is_first ? begin : end - 1)]);
    if (box.contains(p)) found.push_back(p);
  }
  return found;
}

std::vector<Vec3> SurfaceCrossings::first_within(const Box3& box) const {
  return within(box, true);
}

std::vector<Vec3> SurfaceCrossings::last_within(const Box3& box) const {
  return within(box, false);
}

}  // namespace lefort::geometry
