#include <lefort/anatomy/extract_surface.h>
#include <lefort/core/parallel.h>
#include <lefort/dental/blocked_space.h>
#include <lefort/dental/splint.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace lefort::dental {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// Crowns are higher than this over the gingiva and the palate, heuristic.
constexpr double kCrownHeight_mm = 6.0;

/// Values on the columns of a grid, i fastest.
struct ColumnMap {
  Index width = 0, height = 0;
  double spacing_mm = 1.0;
  std::vector<double> values;

  [[nodiscard]] double at(Index i, Index j) const { return values[std::size_t(i + width * j)]; }
};

/// Applies `body(center, other, distance_mm)` to all columns within a radius of each column.
template <class Body>
ColumnMap map_near(const ColumnMap& map, double radius_mm, double start, const Body& body) {
  ColumnMap result = map;
  const auto reach = Index(std::floor(radius_mm / map.spacing_mm));
  parallel_for(map.width * map.height, [&](Index column) {
    const Index i = column % map.width, j = column / map.width;
    double value = start;
    for (Index b = std::max<Index>(j - reach, 0); b <= std::min(j + reach, map.height - 1); ++b)
      for (Index a = std::max<Index>(i - reach, 0); a <= std::min(i + reach, map.width - 1); ++a) {
        const double distance_mm = map.spacing_mm * std::hypot(double(a - i), double(b - j));
        if (distance_mm <= radius_mm) value = body(value, map.at(a, b), distance_mm);
      }
    result.values[std::size_t(column)] = value;
  });
  return result;
}

/// Mean over a square; NaN is left out.
ColumnMap smoothed(const ColumnMap& map, double radius_mm) {
  ColumnMap result = map;
  const auto reach = Index(std::ceil(radius_mm / map.spacing_mm));
  parallel_for(map.width * map.height, [&](Index column) {
    const Index i = column % map.width, j = column / map.width;
    double sum = 0.0;
    Index count = 0;
    for (Index b = std::max<Index>(j - reach, 0); b <= std::min(j + reach, map.height - 1); ++b)
      for (Index a = std::max<Index>(i - reach, 0); a <= std::min(i + reach, map.width - 1); ++a)
        if (const double value = map.at(a, b); !std::isnan(value)) {
          sum += value;
          ++count;
        }
    result.values[std::size_t(column)] = count > 0 ? sum / double(count) : kNone;
  });
  return result;
}

/// Heights of an arch, growing towards the other one.
ColumnMap heights_of(const BlockedSpace& space, bool is_upper) {
  const image::Grid& grid = space.level.grid;
  ColumnMap map{grid.size[0], grid.size[1], grid.spacing_mm.x(), space.border_mm};
  if (is_upper)
    for (double& value : map.values) value = -value;
  return map;
}

double percentile(std::vector<double> values, double part) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return kNone;
  const auto n = std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + n, values.end());
  return values[std::size_t(n)];
}

/// What a splint covers of an arch.
struct Cover {
  ColumnMap heights;  ///< Of the arch where it is covered, NaN elsewhere.
  ColumnMap limits;   ///< How far the splint reaches; defined everywhere.
};

/// Covered is what lies less than `cover_mm` behind the cusps around, and belongs to the crowns.
Cover cover_of(const BlockedSpace& space, bool is_upper, double cover_mm) {
  constexpr double kCusps_mm = 4.0, kCuspPart = 0.98, kSmooth_mm = 1.5;
  Cover cover{heights_of(space, is_upper), {}};
  const double cusps_mm = percentile(cover.heights.values, kCuspPart);
  const auto higher = [](double value, double other, double) {
    return std::isnan(other) ? value : std::max(value, other);
  };
  ColumnMap around =
      map_near(cover.heights, kCusps_mm, -std::numeric_limits<double>::infinity(), higher);
  for (std::size_t c = 0; c < around.values.size(); ++c) {
    double& height = cover.heights.values[c];
    double& level = around.values[c];
    if (!(height >= std::max(level - cover_mm, cusps_mm - kCrownHeight_mm))) height = kNone;
    level = std::max(level, cusps_mm - kCrownHeight_mm) - cover_mm;
  }
  cover.limits = smoothed(around, kSmooth_mm);
  return cover;
}

/// Distance from the covered columns of both arches in the occlusal plane, up to `limit_mm`.
ColumnMap distance_to_cover(const Cover& upper, const Cover& lower, double limit_mm) {
  ColumnMap covered = lower.heights;
  for (std::size_t c = 0; c < covered.values.size(); ++c)
    if (std::isnan(covered.values[c])) covered.values[c] = upper.heights.values[c];
  const ColumnMap distance =
      map_near(covered, limit_mm, limit_mm, [](double value, double other, double distance_mm) {
        return std::isnan(other) ? value : std::min(value, distance_mm);
      });
  return smoothed(distance, distance.spacing_mm);
}

/// The grid around both arches where they face each other, along the directions of the arches.
Result<image::Grid> grid_between(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                                 const ArchAxes& axes, const SplintOptions& options) {
  constexpr double kMaxArch_mm = 150.0, kMaxGap_mm = 20.0;
  image::Grid grid;
  grid.direction << axes.left_L(), -axes.anterior_L, axes.superior_L;
  grid.spacing_mm = Vec3::Constant(options.voxel_mm);
  const auto box_of = [&](const TriangleMesh& mesh) {
    Box3 box;
    for (const Vec3& p : mesh.vertices) box.extend(grid.direction.transpose() * p);
    return box;
  };
  const Box3 upper = box_of(upper_L), lower = box_of(lower_L);
  Box3 box = upper.merged(lower);
  if (box.sizes().head<2>().maxCoeff() > kMaxArch_mm ||
      upper.min().z() - lower.max().z() > kMaxGap_mm)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the arches are {:.0f} x {:.0f} mm large and {:.0f} mm apart, must be "
                            "{:g} and {:g} or less: are both in mm, and in occlusion?",
                            box.sizes().x(), box.sizes().y(), upper.min().z() - lower.max().z(),
                            kMaxArch_mm, kMaxGap_mm));
  const double margin_mm = options.wall_mm + 4.0 * options.voxel_mm;
  // Heights between the cusps and what is covered of the lowest crowns.
  const double below =
      std::min(lower.max().z(), upper.min().z()) - kCrownHeight_mm - options.cover_mm;
  const double above =
      std::max(lower.max().z(), upper.min().z()) + kCrownHeight_mm + options.cover_mm;
  box.min() = Vec3(box.min().x() - margin_mm, box.min().y() - margin_mm, below);
  box.max() = Vec3(box.max().x() + margin_mm, box.max().y() + margin_mm, above);
  grid.origin_L = grid.direction * box.min();
  for (Index axis = 0; axis < 3; ++axis)
    grid.size[std::size_t(axis)] = Index(std::ceil(box.sizes()[axis] / options.voxel_mm)) + 1;
  return grid;
}

/// Level of the splint: its body without both blocked spaces.
image::ScalarVolume level_of(const BlockedSpace& upper, const BlockedSpace& lower,
                             const SplintOptions& options, double& min_thickness_mm) {
  const image::Grid& grid = upper.level.grid;
  const Cover from_upper = cover_of(upper, true, options.cover_mm);
  const Cover from_lower = cover_of(lower, false, options.cover_mm);
  const ColumnMap away =
      distance_to_cover(from_upper, from_lower, options.wall_mm + 2.0 * options.voxel_mm);
  image::ScalarVolume level{grid, std::vector<float>(std::size_t(grid.voxel_count()))};
  parallel_for(grid.size[1] * grid.size[2], [&](Index line) {
    const Index j = line % grid.size[1], k = line / grid.size[1];
    const double z = grid.spacing_mm.z() * double(k);
    for (Index i = 0; i < grid.size[0]; ++i) {
      const bool is_outermost = i == 0 || j == 0 || k == 0 || i + 1 == grid.size[0] ||
                                j + 1 == grid.size[1] || k + 1 == grid.size[2];
      const double body = std::min({options.wall_mm - away.at(i, j), z - from_lower.limits.at(i, j),
                                    -from_upper.limits.at(i, j) - z});
      const double blocked = std::max(upper.level.at(i, j, k), lower.level.at(i, j, k));
      level.at(i, j, k) = is_outermost ? -1.0F : float(std::min(body, -blocked));
    }
  });
  min_thickness_mm = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < from_lower.heights.values.size(); ++c) {
    const double between = -from_upper.heights.values[c] - from_lower.heights.values[c];
    if (!std::isnan(between)) min_thickness_mm = std::min(min_thickness_mm, between);
  }
  return level;
}

/// \param occlusal  from the arch to the other one.
SplintFit fit_of(const Bvh& arch, const Bvh& splint, const Vec3& occlusal) {
  constexpr double kNear_mm = 0.5, kFacing = 0.5, kWay_mm = 10.0, kStep_mm = 0.5;
  const TriangleMesh& mesh = arch.mesh();
  std::vector<double> clearances(mesh.vertices.size(), kNone);
  std::vector<double> depths(mesh.vertices.size(), 0.0);
  const Box3 box = geometry::bounding_box(splint.mesh());
  parallel_for(mesh.vertex_count(), [&](Index v) {
    const Vec3& p = mesh.vertices[std::size_t(v)];
    for (double way_mm = 0.0; way_mm <= kWay_mm; way_mm += kStep_mm) {
      const Vec3 at = p - way_mm * occlusal;
      if (box.exteriorDistance(at) > kNear_mm) continue;
      const double gap_mm = splint.signed_distance(at).distance_mm;
      depths[std::size_t(v)] = std::max(depths[std::size_t(v)], -gap_mm);
      if (way_mm == 0.0 && gap_mm < kNear_mm &&
          arch.pseudonormals().at_vertex(mesh, v).dot(occlusal) > kFacing)
        clearances[std::size_t(v)] = gap_mm;
    }
  });
  return {percentile(clearances, 0.05), percentile(clearances, 0.5), percentile(clearances, 0.95),
          *std::max_element(depths.begin(), depths.end())};
}

Result<void> check(const SplintOptions& options) {
  const auto in = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  if (in(options.clearance_mm, 0.0, 0.5) && in(options.cover_mm, 0.5, 6.0) &&
      in(options.wall_mm, 1.0, 6.0) && in(options.voxel_mm, 0.1, 0.5))
    return {};
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("clearance {} mm, cover {} mm, wall {} mm, voxel {} mm: must be 0 to 0.5, "
                  "0.5 to 6, 1 to 6, 0.1 to 0.5",
                  options.clearance_mm, options.cover_mm, options.wall_mm, options.voxel_mm));
}

}  // namespace

Result<Splint> make_splint(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                           const ArchAxes& axes, const SplintOptions& options, Progress& progress) {
  LEFORT_TRY_VOID(check(options));
  LEFORT_TRY_VOID(geometry::check_surface(upper_L));
  LEFORT_TRY_VOID(geometry::check_surface(lower_L));
  LEFORT_TRY(const image::Grid grid, grid_between(upper_L, lower_L, axes, options));
  const Arches arches{Bvh(upper_L), Bvh(lower_L)};
  progress.begin_stage("space of the arches");
  const BlockedSpace upper = block_space(arches.upper, grid, true, options.clearance_mm);
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the splint was cancelled");
  progress.report(0.5);
  const BlockedSpace lower = block_space(arches.lower, grid, false, options.clearance_mm);
  progress.begin_stage("body of the splint");
  Splint splint;
  const image::ScalarVolume level = level_of(upper, lower, options, splint.min_thickness_mm);
  constexpr double kMinPart_ml = 0.1;
  auto surface_L = anatomy::extract_isosurface(level, {kMinPart_ml}, progress);
  if (!surface_L && surface_L.error().code == ErrorCode::kMeshInvalid)
    return fail(ErrorCode::kMeshInvalid,
                "there is no space for a splint between the arches: are upper and lower swapped, "
                "or in different frames, or do triangles face inward?");
  LEFORT_TRY(splint.surface_L, std::move(surface_L));
  splint.volume_ml = 1e-3 * geometry::signed_volume_mm3(splint.surface_L);
  progress.begin_stage("fit of the splint");
  const Bvh surface(splint.surface_L);
  splint.upper = fit_of(arches.upper, surface, -axes.superior_L);
  splint.lower = fit_of(arches.lower, surface, axes.superior_L);
  return splint;
}

}  // namespace lefort::dental
