#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/voxel_mask.h>
#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/dental/crowns.h>
#include <lefort/geometry/pseudonormals.h>
#include <lefort/image/interpolate.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace lefort::dental {
namespace {

using anatomy::Tooth;
using anatomy::ToothMap;

/// Enamel has more than 2000 HU; voxels average it with dentin (anatomy/find_teeth.cpp).
constexpr double kEnamel_hu = 1700.0;
constexpr double kMinEnamel_mm3 = 100.0;  // About two crowns.
constexpr double kMinArch_mm = 25.0;
constexpr double kMinFlatness = 2.0;
constexpr double kMinUpright = 0.7;  // 45 degrees.
constexpr Index kMinVertices = 100;
constexpr double kCrown_mm = 6.0;
constexpr double kMaxEnamel = 1.25;  // Of the median of enamel; more is metal.
/// The CT number at a border may differ from border_hu by this fraction, from interpolation.
constexpr double kBorderTolerance = 0.25;

/// Positions and CT numbers of the enamel of a jaw.
struct Enamel {
  std::vector<Vec3> points_L;
  std::vector<double> hu;
  Vec3 teeth_L = Vec3::Zero();  ///< Mean of crowns and roots.
};

Enamel enamel_of(const image::CtVolume& ct, const ToothMap& teeth, Tooth jaw) {
  Enamel enamel;
  double count = 0.0;
  const auto& size = ct.grid.size;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) {
        if (teeth.at(i, j, k) != jaw) continue;
        const Vec3 p_L = ct.grid.point_L({double(i), double(j), double(k)});
        enamel.teeth_L += p_L;
        count += 1.0;
        if (ct.at(i, j, k) < kEnamel_hu) continue;
        enamel.points_L.push_back(p_L);
        enamel.hu.push_back(ct.at(i, j, k));
      }
  if (count > 0.0) enamel.teeth_L /= count;
  return enamel;
}

/// What the enamel says of the plane through it.
struct PlaneFit {
  double length_mm = 0.0;  ///< Extent along the longest axis.
  /// Variance along the second axis over that across the plane: 1 for a straight row of teeth.
  double flatness = 0.0;
};

/// Sets center and axes.
PlaneFit fit_plane(const Enamel& enamel, Crowns& crowns) {
  crowns.center_L = Vec3::Zero();
  for (const Vec3& p : enamel.points_L) crowns.center_L += p / double(enamel.points_L.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : enamel.points_L) {
    const Vec3 arm = p - crowns.center_L;
    spread += arm * arm.transpose() / double(enamel.points_L.size());
  }
  const SymmetricEigen<3> axes = symmetric_eigen(spread);
  crowns.occlusal_L = axes.vectors.col(0);
  const double side = crowns.jaw == Tooth::kUpper ? -1.0 : 1.0;
  if (crowns.occlusal_L.z() * side < 0.0) crowns.occlusal_L = -crowns.occlusal_L;
  const Vec3 anterior = -Vec3::UnitY();
  crowns.anterior_L = (anterior - anterior.dot(crowns.occlusal_L) * crowns.occlusal_L).normalized();
  double low = 0.0, high = 0.0;
  for (const Vec3& p : enamel.points_L) {
    const double along = (p - crowns.center_L).dot(axes.vectors.col(2));
    low = std::min(low, along);
    high = std::max(high, along);
  }
  return {high - low, axes.values[1] / std::max(axes.values[0], 1e-9)};
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The box of a jaw's teeth, with a margin.
struct VoxelBox {
  std::array<Index, 3> low, high;  ///< Both included; within the grid.
};

VoxelBox box_of(const ToothMap& teeth, Tooth jaw) {
  constexpr Index kMargin = 3;
  const auto& size = teeth.grid.size;
  VoxelBox box{size, {-1, -1, -1}};
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) {
        if (teeth.at(i, j, k) != jaw) continue;
        const std::array<Index, 3> at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          box.low[a] = std::min(box.low[a], at[a]);
          box.high[a] = std::max(box.high[a], at[a]);
        }
      }
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = std::max<Index>(box.low[a] - kMargin, 0);
    box.high[a] = std::min(box.high[a] + kMargin, size[a] - 1);
  }
  return box;
}

/// The grid of a box, and one voxel more on each side.
image::Grid grid_of(const image::Grid& all, const VoxelBox& box) {
  image::Grid grid = all;
  grid.origin_L =
      all.point_L({double(box.low[0]) - 1.0, double(box.low[1]) - 1.0, double(box.low[2]) - 1.0});
  for (std::size_t a = 0; a < 3; ++a) grid.size[a] = box.high[a] - box.low[a] + 3;
  return grid;
}

/// (CT number - border) / border around the teeth of a jaw, -1 elsewhere.
image::ScalarVolume level_of(const image::CtVolume& ct, const ToothMap& teeth, Tooth jaw,
                             double border_hu) {
  const VoxelBox box = box_of(teeth, jaw);
  const image::Grid grid = grid_of(ct.grid, box);
  anatomy::Mask mask{grid, std::vector<std::uint8_t>(std::size_t(grid.voxel_count()), 0)};
  image::ScalarVolume level{grid, std::vector<float>(std::size_t(grid.voxel_count()), -1.0F)};
  const auto for_each = [&](const auto& body) {
    for (Index k = box.low[2]; k <= box.high[2]; ++k)
      for (Index j = box.low[1]; j <= box.high[1]; ++j)
        for (Index i = box.low[0]; i <= box.high[0]; ++i)
          body(
              i, j, k,
              std::size_t(grid.offset(i - box.low[0] + 1, j - box.low[1] + 1, k - box.low[2] + 1)));
  };
  for_each([&](Index i, Index j, Index k, std::size_t v) {
    mask.values[v] = teeth.at(i, j, k) == jaw ? 1 : 0;
  });
  mask = anatomy::dilated_by_one_voxel_or_more(mask, 1.0);
  for_each([&](Index i, Index j, Index k, std::size_t v) {
    if (mask.values[v] != 0)
      level.values[v] = float((double(ct.at(i, j, k)) - border_hu) / border_hu);
  });
  return level;
}

/// Triangles of crowns whose corners lie on a border of enamel.
geometry::TriangleMesh keep_crowns(const geometry::TriangleMesh& mesh_L, const image::CtVolume& ct,
                                   const Crowns& crowns) {
  std::vector<std::int32_t> number(mesh_L.vertices.size(), -1);
  std::vector<std::uint8_t> is_kept(mesh_L.vertices.size(), 0);
  for (std::size_t v = 0; v < mesh_L.vertices.size(); ++v) {
    const Vec3& p_L = mesh_L.vertices[v];
    const double hu = image::interpolate(ct, p_L, 0.0);
    is_kept[v] = crowns.occlusal_L.dot(p_L - crowns.center_L) > -kCrown_mm &&
                 std::abs(hu - crowns.border_hu) < kBorderTolerance * crowns.border_hu;
  }
  geometry::TriangleMesh kept;
  for (const geometry::Triangle& triangle : mesh_L.triangles) {
    if (!std::all_of(triangle.begin(), triangle.end(),
                     [&](std::int32_t v) { return is_kept[std::size_t(v)] != 0; }))
      continue;
    geometry::Triangle renumbered{};
    for (std::size_t c = 0; c < 3; ++c) {
      std::int32_t& n = number[std::size_t(triangle[c])];
      if (n < 0) {
        n = std::int32_t(kept.vertices.size());
        kept.vertices.push_back(mesh_L.vertices[std::size_t(triangle[c])]);
      }
      renumbered[c] = n;
    }
    kept.triangles.push_back(renumbered);
  }
  return kept;
}

/// Moves each vertex along its normal to where the CT number is half way between the largest one
/// inside, without metal, and the smallest one outside (half-maximum height \cite spoor1993).
/// Vertices without such a place within 0.5 mm stay.
void move_to_half_height(geometry::TriangleMesh& mesh_L, const image::CtVolume& ct, double max_hu) {
  constexpr double kStep_mm = 0.1;
  constexpr int kReach = 15, kMaxSteps = 5;
  const geometry::Pseudonormals normals(mesh_L);
  std::vector<Vec3> moved = mesh_L.vertices;
  parallel_for(mesh_L.vertex_count(), [&](Index v) {
    const Vec3& p_L = mesh_L.vertices[std::size_t(v)];
    const Vec3 n = normals.at_vertex(mesh_L, v);
    std::array<double, 2 * kReach + 1> hu{};
    for (int s = -kReach; s <= kReach; ++s)
      hu[std::size_t(s + kReach)] = image::interpolate(ct, Vec3(p_L + s * kStep_mm * n), 0.0);
    const auto middle = hu.begin() + kReach;
    const double inside = std::min(*std::max_element(hu.begin(), middle + 1), max_hu);
    const double half = 0.5 * (inside + *std::min_element(middle, hu.end()));
    for (int s = 0; s < kMaxSteps; ++s)
      for (const int at : {s, -s - 1}) {
        const double a = *(middle + at), b = *(middle + at + 1);
        if (!(a >= half && half > b)) continue;
        moved[std::size_t(v)] = p_L + kStep_mm * (at + (a - half) / (a - b)) * n;
        return;
      }
  });
  mesh_L.vertices = std::move(moved);
}

}  // namespace

Result<Crowns> find_crowns(const image::CtVolume& ct, const ToothMap& teeth, Tooth jaw,
                           Progress& progress) {
  Crowns crowns;
  crowns.jaw = jaw;
  const Enamel enamel = enamel_of(ct, teeth, jaw);
  const double enamel_mm3 = double(enamel.points_L.size()) * ct.grid.spacing_mm.prod();
  if (enamel_mm3 < kMinEnamel_mm3)
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("the {} teeth have {:.0f} mm3 of enamel in the scan, must be {:g} or "
                            "more: the jaw is toothless, cut off, or its teeth were not found",
                            name_of(jaw), enamel_mm3, kMinEnamel_mm3));
  const PlaneFit plane = fit_plane(enamel, crowns);
  if (plane.length_mm < kMinArch_mm || plane.flatness < kMinFlatness ||
      std::abs(crowns.occlusal_L.z()) < kMinUpright)
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("the {} teeth determine no occlusal plane: they extend over {:.0f} mm "
                            "(must be {:g} or more), or are in a row, or the head is not upright",
                            name_of(jaw), plane.length_mm, kMinArch_mm));
  crowns.border_hu = 0.5 * median_of(enamel.hu);
  LEFORT_TRY(const geometry::TriangleMesh surface_L,
             anatomy::extract_isosurface(level_of(ct, teeth, jaw, crowns.border_hu), {}, progress));
  crowns.surface_L = keep_crowns(surface_L, ct, crowns);
  move_to_half_height(crowns.surface_L, ct, kMaxEnamel * 2.0 * crowns.border_hu);
  if (crowns.surface_L.vertex_count() < kMinVertices)
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("the {} crowns have {} vertices on the border of enamel, must be {} or "
                            "more: do the labels fit the scan?",
                            name_of(jaw), crowns.surface_L.vertex_count(), kMinVertices));
  return crowns;
}

}  // namespace lefort::dental
