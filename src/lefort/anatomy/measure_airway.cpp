#include <lefort/anatomy/measure_airway.h>
#include <lefort/anatomy/minimal_path.h>
#include <lefort/anatomy/pad_volume.h>
#include <lefort/anatomy/voxel_mask.h>
#include <lefort/image/interpolate.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace lefort::anatomy {
namespace {

constexpr double kOpenAir_hu = -1000.0, kMucosa_hu = 40.0;
/// Air beyond the planes that is kept, so that oblique sections at the ends are complete.
constexpr double kBeyond_mm = 12.0;
constexpr double kLattice_mm = 0.25;
constexpr double kSectionReach_mm = 45.0;
constexpr double kMinAirway_ml = 0.1;

/// Extent of a voxel along a direction, at most.
double extent_mm(const image::Grid& grid, const Vec3& along_L) {
  return (grid.direction.transpose() * along_L).cwiseAbs().dot(grid.spacing_mm);
}

double above(const Vec3& p_L, const Vec3& plane_L, const AirwayLimits& limits) {
  return limits.superior_L.dot(p_L - plane_L);
}

/// Airway posterior to the front and not far beyond the planes.
Mask airway_near(const LabelMap& labels, const AirwayLimits& limits) {
  return mask_where(labels.grid, [&](std::size_t v) {
    if (labels.values[v] != Tissue::kAirway) return false;
    const Vec3 p_L = labels.grid.center_L(Index(v));
    return limits.anterior_L.dot(p_L - limits.front_L) <= 0.0 &&
           above(p_L, limits.upper_L, limits) <= kBeyond_mm &&
           above(p_L, limits.lower_L, limits) >= -kBeyond_mm;
  });
}

bool is_between(const Vec3& p_L, const AirwayLimits& limits) {
  return above(p_L, limits.upper_L, limits) <= 0.0 && above(p_L, limits.lower_L, limits) >= 0.0;
}

/// The components with 0.1 ml or more between the planes.
Mask large_components(const Mask& air, const AirwayLimits& limits) {
  const Components parts = connected_components(air, Neighbors::kFaces);
  std::vector<Index> voxels(parts.voxels.size(), 0);
  for (std::size_t v = 0; v < air.values.size(); ++v)
    if (air.values[v] != 0 && is_between(air.grid.center_L(Index(v)), limits))
      ++voxels[std::size_t(parts.component_of.values[v])];
  std::vector<std::uint8_t> keep(voxels.size(), 0);
  for (std::size_t part = 1; part < voxels.size(); ++part)
    keep[part] = double(voxels[part]) * voxel_ml(air.grid) >= kMinAirway_ml ? 1 : 0;
  return select_components(parts, keep);
}

/// Fraction of air in each voxel of the airway and at its wall.
image::ScalarVolume air_fraction(const image::CtVolume& ct, const Mask& airway,
                                 const AirwayLimits& limits) {
  const Mask inner = eroded(airway, ct.grid.spacing_mm.maxCoeff());
  const Mask outer = dilated_by_one_voxel_or_more(airway, 0.0);
  image::ScalarVolume fraction{ct.grid, std::vector<float>(ct.values.size(), 0.0F)};
  const double front_mm = extent_mm(ct.grid, limits.anterior_L);
  parallel_for(ct.grid.voxel_count(), [&](Index v) {
    const auto at = std::size_t(v);
    if (outer.values[at] == 0) return;
    double air = 1.0;
    if (inner.values[at] == 0)
      air = std::clamp((kMucosa_hu - double(ct.values[at])) / (kMucosa_hu - kOpenAir_hu), 0.0, 1.0);
    const double behind_mm = limits.anterior_L.dot(limits.front_L - ct.grid.center_L(v));
    air *= std::clamp(0.5 + behind_mm / front_mm, 0.0, 1.0);
    fraction.values[at] = float(air);
  });
  return fraction;
}

/// The fraction, multiplied by the fraction of the voxel between the planes.
image::ScalarVolume between_planes(image::ScalarVolume fraction, const AirwayLimits& limits) {
  const double height_mm = extent_mm(fraction.grid, limits.superior_L);
  parallel_for(fraction.grid.voxel_count(), [&](Index v) {
    const Vec3 p_L = fraction.grid.center_L(v);
    const double below = -above(p_L, limits.upper_L, limits) / height_mm;
    const double over = above(p_L, limits.lower_L, limits) / height_mm;
    fraction.values[std::size_t(v)] *=
        float(std::clamp(0.5 + below, 0.0, 1.0) * std::clamp(0.5 + over, 0.0, 1.0));
  });
  return fraction;
}

/// Of the airway between the planes, the voxel that is furthest from the wall among those that are,
/// within half a voxel, as close to a plane as any.
Index widest_voxel_at(const Mask& airway, const image::ScalarVolume& to_wall_mm,
                      const Vec3& plane_L, const AirwayLimits& limits) {
  const auto height_mm = [&](std::size_t v) {
    return std::abs(above(airway.grid.center_L(Index(v)), plane_L, limits));
  };
  const auto counts = [&](std::size_t v) {
    return airway.values[v] != 0 && is_between(airway.grid.center_L(Index(v)), limits);
  };
  double closest_mm = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < airway.values.size(); ++v)
    if (counts(v)) closest_mm = std::min(closest_mm, height_mm(v));
  closest_mm += 0.5 * extent_mm(airway.grid, limits.superior_L);
  Index widest = -1;
  for (std::size_t v = 0; v < airway.values.size(); ++v)
    if (counts(v) && height_mm(v) <= closest_mm &&
        (widest < 0 || to_wall_mm.values[v] > to_wall_mm.values[std::size_t(widest)]))
      widest = Index(v);
  return widest;
}

std::vector<Vec3> center_line(const Mask& airway, const AirwayLimits& limits) {
  const image::ScalarVolume to_wall_mm =
      distance_to(mask_where(airway.grid, [&](std::size_t v) { return airway.values[v] == 0; }));
  // Through tissue the path is possible, but shorter than through any air.
  constexpr float kThroughTissue = 1e-3F;
  image::ScalarVolume speed = to_wall_mm;
  for (float& value : speed.values) value = std::max(value * value, kThroughTissue);
  const FrontSource source{widest_voxel_at(airway, to_wall_mm, limits.upper_L, limits)};
  const Index end = widest_voxel_at(airway, to_wall_mm, limits.lower_L, limits);
  constexpr double kSmoothing_mm = 3.0, kSpacing_mm = 1.0;
  return smoothed_path(minimal_path(arrival_times(speed, {&source, 1}, end), end), kSmoothing_mm,
                       kSpacing_mm);
}

/// Cells of a lattice in a plane.
class PlaneLattice {
 public:
  PlaneLattice(const image::ScalarVolume& fraction, const AirwaySection& section,
               const AirwayLimits& limits)
      : fraction_(fraction), center_L_(section.center_L), cells_(std::size_t(kSide * kSide), 0) {
    const Vec3 left_L = limits.superior_L.cross(limits.anterior_L).normalized();
    left_L_ = (left_L - section.normal_L * section.normal_L.dot(left_L)).normalized();
    other_L_ = section.normal_L.cross(left_L_);
  }

  /// The connected cells with air around the one with air that is closest to the center.
  void fill(AirwaySection& section) {
    constexpr int kStartReach = int(3.0 / kLattice_mm);
    std::optional<std::pair<int, int>> start;
    int closest = 2 * kStartReach * kStartReach;
    for (int y = -kStartReach; y <= kStartReach; ++y)
      for (int x = -kStartReach; x <= kStartReach; ++x)
        if (x * x + y * y < closest && has_air(x, y)) {
          closest = x * x + y * y;
          start = {x, y};
        }
    if (!start) return;
    std::vector<std::pair<int, int>> stack{*start};
    cell(start->first, start->second) = 1;
    int count = 0, left = start->first, right = left, low = start->second, high = low;
    while (!stack.empty()) {
      const auto [x, y] = stack.back();
      stack.pop_back();
      ++count;
      left = std::min(left, x), right = std::max(right, x);
      low = std::min(low, y), high = std::max(high, y);
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int a = x + dx, b = y + dy;
        if (std::max(std::abs(a), std::abs(b)) > kReach || cell(a, b) != 0 || !has_air(a, b))
          continue;
        cell(a, b) = 1;
        stack.emplace_back(a, b);
      }
    }
    section.area_mm2 = double(count) * kLattice_mm * kLattice_mm;
    section.width_mm = double(right - left + 1) * kLattice_mm;
    section.depth_mm = double(high - low + 1) * kLattice_mm;
  }

 private:
  static constexpr int kReach = int(kSectionReach_mm / kLattice_mm);
  static constexpr int kSide = 2 * kReach + 1;

  std::uint8_t& cell(int x, int y) {
    return cells_[std::size_t(y + kReach) * std::size_t(kSide) + std::size_t(x + kReach)];
  }
  [[nodiscard]] bool has_air(int x, int y) const {
    return image::interpolate(
               fraction_, center_L_ + kLattice_mm * (double(x) * left_L_ + double(y) * other_L_),
               0.0) >= 0.5;
  }

  const image::ScalarVolume& fraction_;
  Vec3 center_L_, left_L_, other_L_;
  std::vector<std::uint8_t> cells_;
};

std::size_t smallest(const std::vector<AirwaySection>& sections) {
  const auto by_area = [](const AirwaySection& a, const AirwaySection& b) {
    return a.area_mm2 < b.area_mm2;
  };
  return std::size_t(std::min_element(sections.begin(), sections.end(), by_area) -
                     sections.begin());
}

/// Unit length; to inferior if the points coincide.
Vec3 direction_between(const Vec3& from_L, const Vec3& to_L, const AirwayLimits& limits) {
  const Vec3 along_L = to_L - from_L;
  return along_L.norm() > 1e-9 ? Vec3(along_L.normalized()) : Vec3(-limits.superior_L);
}

void measure_sections(const std::vector<Vec3>& line_L, const image::ScalarVolume& fraction,
                      const AirwayLimits& limits, Airway& airway) {
  airway.sections.resize(line_L.size());
  airway.axial.resize(line_L.size());
  double along_mm = 0.0;
  for (std::size_t n = 0; n < line_L.size(); ++n) {
    if (n > 0) along_mm += (line_L[n] - line_L[n - 1]).norm();
    const std::size_t from = n > 0 ? n - 1 : 0, to = std::min(n + 1, line_L.size() - 1);
    airway.sections[n] = {along_mm, line_L[n], direction_between(line_L[from], line_L[to], limits)};
    airway.axial[n] = {along_mm, line_L[n], -limits.superior_L};
  }
  parallel_for(
      Index(line_L.size()),
      [&](Index n) {
        for (AirwaySection* const one :
             {&airway.sections[std::size_t(n)], &airway.axial[std::size_t(n)]})
          PlaneLattice(fraction, *one, limits).fill(*one);
      },
      1);
  airway.length_mm = along_mm;
  for (std::size_t n = 1; n < line_L.size(); ++n)
    if (airway.sections[n].area_mm2 == 0.0) airway.closed_mm += (line_L[n] - line_L[n - 1]).norm();
  airway.min_section = smallest(airway.sections);
  airway.min_axial = smallest(airway.axial);
}

Result<Airway> no_airway() {
  return fail(ErrorCode::kAnatomyMissing,
              "there is no airway between the limits: check the labels and the two planes");
}

}  // namespace

Result<Airway> measure_airway(const image::CtVolume& ct, const LabelMap& labels,
                              const AirwayLimits& limits) {
  constexpr double kMinHeight_mm = 5.0;
  if (!(above(limits.upper_L, limits.lower_L, limits) > kMinHeight_mm))
    return fail(ErrorCode::kInvalidArgument,
                "the upper limit of the airway is not above the lower by 5 mm or more");
  const Mask everywhere = airway_near(labels, limits);
  if (voxel_count(everywhere) == 0) return no_airway();
  const Margin margin = margin_around(labels.grid, {3, 3, 3},
                                      [&](std::size_t v) { return everywhere.values[v] != 0; });
  const image::CtVolume near_ct = cropped(ct, margin);
  const Mask airway = large_components(cropped(everywhere, margin), limits);
  const image::ScalarVolume fraction = air_fraction(near_ct, airway, limits);
  image::ScalarVolume inside = between_planes(fraction, limits);
  double voxels = 0.0;
  for (const float value : inside.values) voxels += double(value);
  Airway result;
  result.volume_ml = voxels * voxel_ml(near_ct.grid);
  if (result.volume_ml < kMinAirway_ml) return no_airway();
  measure_sections(center_line(airway, limits), fraction, limits, result);
  for (float& value : inside.values) value -= 0.5F;
  result.level = std::move(inside);
  return result;
}

}  // namespace lefort::anatomy
