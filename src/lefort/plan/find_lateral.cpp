#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/internal/landmark_rules.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lefort::plan::internal {
namespace {

using geometry::SurfaceCrossings;

/// The outermost bone of one side, on a grid of y and z.
struct LateralView {
  double low_y_mm, low_z_mm;
  Index columns, rows;
  std::vector<double> outward_mm;  ///< |x| of the outermost bone; 0 without bone.

  [[nodiscard]] double at(Index column, Index row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) return 0.0;
    return outward_mm[std::size_t(column + columns * row)];
  }
  [[nodiscard]] Vec3 point(Index column, Index row, double sign) const {
    return {sign * at(column, row), low_y_mm + double(column) * kPixel_mm,
            low_z_mm + double(row) * kPixel_mm};
  }
};

LateralView view_from(const SurfaceCrossings& lines, double sign, const Box3& box) {
  LateralView view{box.min().y(),
                   box.min().z(),
                   Index(box.sizes().y() / kPixel_mm) + 1,
                   Index(box.sizes().z() / kPixel_mm) + 1,
                   {}};
  for (Index row = 0; row < view.rows; ++row)
    for (Index column = 0; column < view.columns; ++column) {
      const Vec3 p(0.0, view.low_y_mm + double(column) * kPixel_mm,
                   view.low_z_mm + double(row) * kPixel_mm);
      const auto outermost = sign > 0.0 ? lines.last(p) : lines.first(p);
      view.outward_mm.push_back(outermost ? std::max(0.0, sign * outermost->x()) : 0.0);
    }
  return view;
}

/// Points of holes: bone lies at least 5 mm further lateral within 9 mm above, below, before and
/// behind them.
std::vector<bool> hole_pixels(const LateralView& view) {
  constexpr double kDepth_mm = 5.0, kWithin_mm = 9.0;
  const Index reach = Index(kWithin_mm / kPixel_mm);
  std::vector<bool> is_hole(view.outward_mm.size(), false);
  constexpr std::array<std::array<Index, 2>, 4> kDirections{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (Index row = 0; row < view.rows; ++row)
    for (Index column = 0; column < view.columns; ++column) {
      double rim_mm = 1e3;
      for (const auto& [dc, dr] : kDirections) {
        double highest_mm = 0.0;
        for (Index step = 1; step <= reach; ++step)
          highest_mm = std::max(highest_mm, view.at(column + step * dc, row + step * dr));
        rim_mm = std::min(rim_mm, highest_mm);
      }
      is_hole[std::size_t(column + view.columns * row)] = view.at(column, row) < rim_mm - kDepth_mm;
    }
  return is_hole;
}

/// The pixels of the connected component that contains a pixel, which are cleared.
std::vector<Index> take_component(std::vector<bool>& is_hole, const LateralView& view,
                                  Index first) {
  std::vector<Index> component{first};
  is_hole[std::size_t(first)] = false;
  for (std::size_t n = 0; n < component.size(); ++n) {
    const Index column = component[n] % view.columns, row = component[n] / view.columns;
    for (Index dr = -1; dr <= 1; ++dr)
      for (Index dc = -1; dc <= 1; ++dc) {
        const Index c = column + dc, r = row + dr;
        if (c < 0 || r < 0 || c >= view.columns || r >= view.rows) continue;
        const Index next = c + view.columns * r;
        if (!is_hole[std::size_t(next)]) continue;
        is_hole[std::size_t(next)] = false;
        component.push_back(next);
      }
  }
  return component;
}

/// The row of the rim above a point of a hole: where the outer surface becomes steeper than 45
/// degrees to the lateral direction.
Index rim_above(const LateralView& view, Index column, Index row) {
  constexpr Index kOver = 2;  // Pixels.
  while (row + kOver < view.rows &&
         view.at(column, row + kOver) - view.at(column, row) > double(kOver) * kPixel_mm)
    ++row;
  return row;
}

/// The top of the rim of the ear canal: of the largest hole of 10 to 250 mm2.
std::optional<Extremum> find_porion(const LateralView& view, double sign) {
  constexpr double kMinArea_mm2 = 10.0, kMaxArea_mm2 = 250.0;
  std::vector<bool> is_hole = hole_pixels(view);
  std::vector<Index> largest;
  for (Index pixel = 0; pixel < Index(is_hole.size()); ++pixel) {
    if (!is_hole[std::size_t(pixel)]) continue;
    std::vector<Index> component = take_component(is_hole, view, pixel);
    const double area_mm2 = double(component.size()) * kPixel_mm * kPixel_mm;
    if (area_mm2 >= kMinArea_mm2 && area_mm2 <= kMaxArea_mm2 && component.size() > largest.size())
      largest = std::move(component);
  }
  if (largest.empty()) return std::nullopt;
  Index top = 0;
  for (const Index pixel : largest) top = std::max(top, pixel / view.columns);
  double sum = 0.0, square = 0.0, count = 0.0;
  for (const Index pixel : largest)
    if (pixel / view.columns >= top - 1) {
      const auto column = double(pixel % view.columns);
      sum += column;
      square += column * column;
      count += 1.0;
    }
  const double middle = sum / count;
  const double spread = std::sqrt(std::max(0.0, square / count - middle * middle));
  const Index column = Index(std::lround(middle));
  return Extremum{view.point(column, rim_above(view, column, top), sign), spread * kPixel_mm};
}

}  // namespace

void find_lateral(const HeadInF& head, LandmarkList& list) {
  for (const Side& side : kSides) {
    const std::string zygion = std::string("Zy") + side.suffix;
    const std::string porion = std::string("Po") + side.suffix;
    const auto orbitale = list.at(std::string("Or") + side.suffix);
    if (!orbitale) {
      list.miss(zygion, "no orbitale on that side");
      list.miss(porion, "no orbitale on that side");
      continue;
    }
    const double inner = 25.0 * side.sign, outer = 110.0 * side.sign;
    const Vec3 low(std::min(inner, outer), orbitale->y() + 10.0, orbitale->z() - 25.0);
    const Vec3 high(std::max(inner, outer), orbitale->y() + 115.0, orbitale->z() + 25.0);
    const SurfaceCrossings lines(head.skull, 0, Box3(low, high), kPixel_mm);
    const Box3 arch(Vec3(low.x(), orbitale->y() + 12.0, orbitale->z() - 18.0),
                    Vec3(high.x(), orbitale->y() + 60.0, orbitale->z() + 8.0));
    const auto outermost = side.sign > 0.0 ? lines.last_within(arch) : lines.first_within(arch);
    list.add(zygion, find_extremum(outermost, Vec3(side.sign, 0.0, 0.0), list.voxel_mm()), 0.5,
             "no zygomatic arch");
    const Box3 ear(Vec3(low.x(), orbitale->y() + 50.0, orbitale->z() - 22.0),
                   Vec3(high.x(), orbitale->y() + 110.0, orbitale->z() + 22.0));
    list.add(porion, find_porion(view_from(lines, side.sign, ear), side.sign), 1.0,
             "no opening of the ear canal in the skull");
  }
}

}  // namespace lefort::plan::internal
