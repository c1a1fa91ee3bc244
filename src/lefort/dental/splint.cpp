#include <lefort/anatomy/extract_surface.h>
#include <lefort/core/parallel.h>
#include <lefort/dental/blocked_space.h>
#include <lefort/dental/check_arch.h>
#include <lefort/dental/column_map.h>
#include <lefort/dental/insertion_fit.h>
#include <lefort/dental/splint.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::dental {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Crowns are higher than this over the gingiva and the palate, heuristic.
constexpr double kCrownHeight_mm = 6.0;
/// Cusps and the fissures between them lie within this distance.
constexpr double kCusps_mm = 4.0;
/// Depth of engraved letters.
constexpr double kTextDepth_mm = 0.6;
/// How far the splint reaches over the cusps of the other arch, where that overlaps this one.
constexpr double kOver_mm = 2.0;

/// Largest value of a square around each column; NaN is left out.
ColumnMap highest_around(const ColumnMap& map, double radius_mm) {
  return filtered(map, radius_mm, [](double value, double other, double) {
    return std::isnan(value) || other > value ? other : value;
  });
}

/// Heights of an arch, growing towards the other one.
ColumnMap heights_of(const BlockedSpace& space, bool is_upper) {
  const image::Grid& grid = space.level.grid;
  ColumnMap map{grid.size[0], grid.size[1], grid.spacing_mm.x(), space.border_mm};
  if (is_upper)
    for (double& value : map.values) value = -value;
  return map;
}

/// What a splint covers of an arch. Heights grow towards the other arch.
struct Cover {
  ColumnMap heights;  ///< Of the arch where it is covered, NaN elsewhere.
  ColumnMap cusps;    ///< The highest covered ones around, as far as the splint reaches; or NaN.
};

/// Covered is what lies less than `cover_mm` behind the cusps around, and belongs to the crowns.
Cover cover_of(const BlockedSpace& space, bool is_upper, const SplintOptions& options) {
  constexpr double kCuspPart = 0.98;
  Cover cover{heights_of(space, is_upper), {}};
  const double gingiva_mm = percentile(cover.heights.values, kCuspPart) - kCrownHeight_mm;
  const ColumnMap around = highest_around(cover.heights, kCusps_mm);
  for (std::size_t c = 0; c < around.values.size(); ++c) {
    double& height = cover.heights.values[c];
    if (!(height >= std::max(around.values[c] - options.cover_mm, gingiva_mm))) height = kNone;
  }
  cover.cusps = highest_around(cover.heights, kCusps_mm + options.wall_mm);
  return cover;
}

/// Whether what is covered extends over most of the arch along i and j. It does not if the
/// directions are tilted.
bool spans_arch(const Cover& cover, const BlockedSpace& space) {
  constexpr double kMinPart = 0.6;
  Eigen::AlignedBox<double, 2> arch, covered;
  for (Index j = 0; j < cover.heights.height; ++j)
    for (Index i = 0; i < cover.heights.width; ++i) {
      const Eigen::Vector2d at(static_cast<double>(i), static_cast<double>(j));
      if (!std::isnan(space.border_mm[std::size_t(i + cover.heights.width * j)])) arch.extend(at);
      if (!std::isnan(cover.heights.at(i, j))) covered.extend(at);
    }
  return !covered.isEmpty() && (covered.sizes().array() >= kMinPart * arch.sizes().array()).all();
}

/// Heights between which the body lies, and its distance from the covered columns of both arches in
/// the occlusal plane. NaN: no body.
struct BodyLimits {
  ColumnMap low, high, away;
  ColumnMap low_cusps, high_cusps;  ///< Heights between which the wall is not a rim.
};

BodyLimits limits_of(const Cover& upper, const Cover& lower, const SplintOptions& options) {
  constexpr double kSmooth_mm = 1.5;
  BodyLimits limits{lower.cusps, lower.cusps, lower.heights, lower.cusps, lower.cusps};
  for (std::size_t c = 0; c < limits.low.values.size(); ++c) {
    const double from_below = lower.cusps.values[c], from_above = -upper.cusps.values[c];
    limits.low.values[c] = std::fmin(from_below - options.cover_mm, from_above - kOver_mm);
    limits.high.values[c] = std::fmax(from_above + options.cover_mm, from_below + kOver_mm);
    limits.low_cusps.values[c] = std::fmin(from_below, from_above);
    limits.high_cusps.values[c] = std::fmax(from_below, from_above);
    const bool is_covered =
        !std::isnan(lower.heights.values[c]) || !std::isnan(upper.heights.values[c]);
    limits.away.values[c] = is_covered ? 0.0 : kInfinity;
  }
  limits.low = smoothed(limits.low, kSmooth_mm);
  limits.high = smoothed(limits.high, kSmooth_mm);
  limits.low_cusps = smoothed(limits.low_cusps, kSmooth_mm);
  limits.high_cusps = smoothed(limits.high_cusps, kSmooth_mm);
  const double spacing_mm = limits.away.spacing_mm, far_mm = options.wall_mm + 2.0 * spacing_mm;
  limits.away = filtered(limits.away, far_mm, [](double value, double other, double squared_mm) {
    return std::min(value, other + squared_mm);
  });
  for (double& value : limits.away.values) value = std::min(std::sqrt(value), far_mm);
  limits.away = smoothed(limits.away, spacing_mm);
  return limits;
}

/// Smallest thickness where the splint covers one arch and the other one is opposite; NaN if they
/// are opposite nowhere.
double min_thickness(const BlockedSpace& upper, const BlockedSpace& lower, const Cover& from_upper,
                     const Cover& from_lower, const BodyLimits& limits) {
  double thickness_mm = kNone;
  for (std::size_t c = 0; c < limits.low.values.size(); ++c) {
    const double top = upper.border_mm[c], bottom = lower.border_mm[c];
    if (std::isnan(top) || std::isnan(bottom)) continue;
    if (std::isnan(from_upper.heights.values[c]) && std::isnan(from_lower.heights.values[c]))
      continue;
    thickness_mm = std::fmin(thickness_mm, std::fmin(top, limits.high.values[c]) -
                                               std::fmax(bottom, limits.low.values[c]));
  }
  return thickness_mm;
}

/// The grid around both arches where they face each other, along the directions of the arches.
Result<image::Grid> grid_between(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                                 const ArchAxes& axes, const SplintOptions& options) {
  constexpr double kMaxGap_mm = 20.0, kSpare_mm = 3.0;
  image::Grid grid;
  grid.direction << axes.left_L(), -axes.anterior_L, axes.superior_L;
  const auto box_of = [&](const TriangleMesh& mesh) {
    Box3 box;
    for (const Vec3& p : mesh.vertices) box.extend(grid.direction.transpose() * p);
    return box;
  };
  const Box3 upper = box_of(upper_L), lower = box_of(lower_L);
  const double gap_mm = upper.min().z() - lower.max().z();
  if (!(std::abs(gap_mm) <= kMaxGap_mm))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the gap of the arches is {:.0f} mm, must be {:g} to {:g} mm: are they in "
                    "the same frame?",
                    gap_mm, -kMaxGap_mm, kMaxGap_mm));
  Box3 box = upper.merged(lower);
  const double margin_mm = options.wall_mm + options.clearance_mm + 4.0 * options.voxel_mm;
  // Heights between the cusps and what is covered of the lowest crowns.
  const double beyond_mm = kCrownHeight_mm + options.cover_mm + kSpare_mm;
  const double low = std::min(lower.max().z(), upper.min().z()) - beyond_mm;
  const double high = std::max(lower.max().z(), upper.min().z()) + beyond_mm;
  box.min() = Vec3(box.min().x() - margin_mm, box.min().y() - margin_mm, low);
  box.max() = Vec3(box.max().x() + margin_mm, box.max().y() + margin_mm, high);
  return grid_in_box(grid.direction, box, options.voxel_mm);
}

/// Intersection of two bodies whose common edge has a radius. Both are given by the distance to
/// their border, positive inside.
double rounded_min(double a, double b, double radius) {
  if (a >= radius || b >= radius) return std::min(a, b);
  return radius - std::hypot(radius - a, radius - b);
}

/// Level of the body at a height of a column.
double body_at(const BodyLimits& limits, Index i, Index j, double z, const SplintOptions& options) {
  constexpr double kBlend_mm = 1.0;  // Over which the wall becomes a rim.
  const double beyond_mm = std::max(limits.low_cusps.at(i, j) - z, z - limits.high_cusps.at(i, j));
  const double part = std::clamp(beyond_mm / kBlend_mm, 0.0, 1.0);
  const double wall_mm = options.wall_mm - part * (options.wall_mm - options.rim_mm);
  return rounded_min(wall_mm - limits.away.at(i, j),
                     std::min(z - limits.low.at(i, j), limits.high.at(i, j) - z), options.edge_mm);
}

/// Level of the splint: its body without both blocked spaces. Takes the place of that of `upper`.
image::ScalarVolume level_of(BlockedSpace&& upper, const BlockedSpace& lower,
                             const BodyLimits& limits, const SplintOptions& options) {
  image::ScalarVolume level = std::move(upper.level);
  const image::Grid& grid = level.grid;
  parallel_for(grid.size[1] * grid.size[2], [&](Index line) {
    const Index j = line % grid.size[1], k = line / grid.size[1];
    const double z = grid.spacing_mm.z() * double(k);
    for (Index i = 0; i < grid.size[0]; ++i) {
      const bool is_outermost = i == 0 || j == 0 || k == 0 || i + 1 == grid.size[0] ||
                                j + 1 == grid.size[1] || k + 1 == grid.size[2];
      const double low = limits.low.at(i, j), high = limits.high.at(i, j);
      const bool has_body = !is_outermost && !std::isnan(low) && !std::isnan(high);
      const double blocked = std::max(level.at(i, j, k), lower.level.at(i, j, k));
      level.at(i, j, k) =
          has_body ? float(std::min(body_at(limits, i, j, z, options), -blocked)) : -1.0F;
    }
  });
  return level;
}

/// Vertices of an arch that the splint covers from the other arch.
std::vector<char> covered_vertices(const Bvh& arch, const image::Grid& grid, const Cover& cover,
                                   bool is_upper, double clearance_mm) {
  constexpr double kFacing = 0.5, kDeep_mm = 0.5;
  const TriangleMesh& mesh = arch.mesh();
  const Vec3 occlusal = (is_upper ? -1.0 : 1.0) * grid.direction.col(2);
  std::vector<char> covered(mesh.vertices.size(), 0);
  parallel_for(mesh.vertex_count(), [&](Index v) {
    const Vec3 at = grid.index_V(mesh.vertices[std::size_t(v)]);
    const auto i = Index(std::lround(at.x())), j = Index(std::lround(at.y()));
    const double z = (is_upper ? -1.0 : 1.0) * at.z() * grid.spacing_mm.z();
    if (!grid.contains(i, j, 0)) return;
    // As far below the border as the arch has grown, and a slope over half a voxel.
    const double below_mm = cover.heights.at(i, j) - z;
    if (below_mm <= clearance_mm + kDeep_mm &&
        arch.pseudonormals().at_vertex(mesh, v).dot(occlusal) > kFacing)
      covered[std::size_t(v)] = 1;
  });
  return covered;
}

Result<void> check(const SplintOptions& options) {
  const auto in = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  if (in(options.clearance_mm, 0.0, 0.5) && in(options.cover_mm, 0.5, 6.0) &&
      in(options.wall_mm, 1.0, 6.0) && in(options.voxel_mm, 0.1, 0.5)) {
    if (options.text.width > 0 && !(options.rim_mm >= 1.0 + kTextDepth_mm))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("the rim is {} mm, must be {:g} or more with text, which is {:g} mm "
                              "deep",
                              options.rim_mm, 1.0 + kTextDepth_mm, kTextDepth_mm));
    if (in(options.rim_mm, 1.0, options.wall_mm) && in(options.edge_mm, 0.0, 0.5 * options.rim_mm))
      return {};
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the rim is {} mm and its edge {} mm: must be 1 to {} mm (the wall), "
                            "and 0 to half of the rim",
                            options.rim_mm, options.edge_mm, options.wall_mm));
  }
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("clearance {} mm, cover {} mm, wall {} mm, voxel {} mm: must be 0 to 0.5, "
                  "0.5 to 6, 1 to 6, 0.1 to 0.5",
                  options.clearance_mm, options.cover_mm, options.wall_mm, options.voxel_mm));
}

/// The surface of the level, and how many parts it has.
Result<void> extract(const image::ScalarVolume& level, Splint& splint, Progress& progress) {
  constexpr double kMinPart_ml = 0.1;
  auto surface_L = anatomy::extract_isosurface(level, {kMinPart_ml}, progress);
  if (!surface_L && surface_L.error().code == ErrorCode::kMeshInvalid)
    return fail(ErrorCode::kMeshInvalid,
                "there is no space for a splint between the arches: open them");
  LEFORT_TRY(splint.surface_L, std::move(surface_L));
  splint.parts = geometry::connected_components(splint.surface_L).count;
  splint.volume_ml = 1e-3 * geometry::signed_volume_mm3(splint.surface_L);
  return {};
}

Result<void> check_cover(const Cover& cover, const BlockedSpace& space, const char* name) {
  if (spans_arch(cover, space)) return {};
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("the splint would cover a part of the {} arch only: the occlusal plane is "
                  "tilted, give its directions with --arches",
                  name));
}

}  // namespace

Result<Splint> make_splint(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                           const ArchAxes& axes, const SplintOptions& options, Progress& progress) {
  const auto cancelled = [] { return fail(ErrorCode::kCancelled, "the splint was cancelled"); };
  LEFORT_TRY_VOID(check(options));
  LEFORT_TRY_VOID(check_arch(upper_L, "upper", -axes.superior_L));
  LEFORT_TRY_VOID(check_arch(lower_L, "lower", axes.superior_L));
  LEFORT_TRY(const image::Grid grid, grid_between(upper_L, lower_L, axes, options));
  const Arches arches{Bvh(upper_L), Bvh(lower_L)};
  progress.begin_stage("space of the arches");
  BlockedSpace upper = block_space(arches.upper, grid, true, options.clearance_mm, progress);
  progress.report(0.5);
  const BlockedSpace lower = block_space(arches.lower, grid, false, options.clearance_mm, progress);
  if (progress.stop_requested()) return cancelled();
  progress.begin_stage("body of the splint");
  const Cover from_upper = cover_of(upper, true, options);
  const Cover from_lower = cover_of(lower, false, options);
  LEFORT_TRY_VOID(check_cover(from_upper, upper, "upper"));
  LEFORT_TRY_VOID(check_cover(from_lower, lower, "lower"));
  const BodyLimits limits = limits_of(from_upper, from_lower, options);
  Splint splint;
  splint.min_thickness_mm = min_thickness(upper, lower, from_upper, from_lower, limits);
  if (std::isnan(splint.min_thickness_mm))
    return fail(ErrorCode::kInvalidArgument,
                "no tooth is opposite another one along the superior direction");
  image::ScalarVolume level = level_of(std::move(upper), lower, limits, options);
  LEFORT_TRY_VOID(engrave_front(level, options.text, kTextDepth_mm));
  LEFORT_TRY_VOID(extract(level, splint, progress));
  progress.begin_stage("fit of the splint");
  const Bvh surface(splint.surface_L);
  splint.upper =
      insertion_fit(upper_L, surface,
                    covered_vertices(arches.upper, grid, from_upper, true, options.clearance_mm),
                    -axes.superior_L, progress);
  splint.lower =
      insertion_fit(lower_L, surface,
                    covered_vertices(arches.lower, grid, from_lower, false, options.clearance_mm),
                    axes.superior_L, progress);
  if (progress.stop_requested()) return cancelled();
  return splint;
}

}  // namespace lefort::dental
