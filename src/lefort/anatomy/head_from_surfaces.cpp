#include <lefort/anatomy/find_brain.h>
#include <lefort/anatomy/head_from_surfaces.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace lefort::anatomy {
namespace {

using geometry::TriangleMesh;

constexpr double kOutside_hu = -1000.0, kTissue_hu = 40.0, kCortical_hu = 1200.0;
constexpr double kSkinThreshold_hu = -300.0, kBoneThreshold_hu = 226.0;
constexpr double kBand_voxels = 4.0;  // Distances are exact within this many voxels of a surface.
constexpr double kMaxVoxels = 5e8;

/// A welded surface that is closed and oriented outward.
Result<TriangleMesh> checked_surface(const TriangleMesh& given_L, const std::string& name) {
  if (const Result<void> valid = geometry::check_surface(given_L); !valid)
    return fail(valid.error().code, fmt::format("{}: {}", name, valid.error().message));
  TriangleMesh surface_L = geometry::weld_vertices(given_L);
  if (const auto edge = geometry::first_open_edge(surface_L))
    return fail(ErrorCode::kMeshInvalid, fmt::format("{}: the surface is open ({}), must be closed",
                                                     name, geometry::describe(*edge)));
  if (geometry::signed_volume_mm3(surface_L) < 0.0)
    for (geometry::Triangle& t : surface_L.triangles) std::swap(t[1], t[2]);
  return surface_L;
}

/// \returns whether the surface ends in a flat face at one side of its box.
bool ends_flat(const TriangleMesh& surface_L, const Box3& box, Index axis, bool is_high) {
  constexpr double kFlat_mm2 = 400.0, kWithin_mm = 0.2, kAligned = 0.9994;  // cos(2 deg)
  const double end_mm = is_high ? box.max()[axis] : box.min()[axis];
  double area_mm2 = 0.0;
  for (Index t = 0; t < surface_L.triangle_count(); ++t) {
    const Vec3 &a = surface_L.corner(t, 0), &b = surface_L.corner(t, 1),
               &c = surface_L.corner(t, 2);
    if (std::max({std::abs(a[axis] - end_mm), std::abs(b[axis] - end_mm),
                  std::abs(c[axis] - end_mm)}) > kWithin_mm)
      continue;
    const Vec3 twice = (b - a).cross(c - a);
    if (std::abs(twice[axis]) >= kAligned * twice.norm()) area_mm2 += 0.5 * twice.norm();
  }
  return area_mm2 >= kFlat_mm2;
}

/// A grid around the skin, which ends within its flat ends.
Result<image::Grid> grid_around(const TriangleMesh& skin_L, double voxel_mm) {
  constexpr double kAir_voxels = 4.0, kCutOff_voxels = 2.0;
  const Box3 box = geometry::bounding_box(skin_L);
  image::Grid grid;
  grid.spacing_mm = Vec3::Constant(voxel_mm);
  double voxels = 1.0;
  for (Index axis = 0; axis < 3; ++axis) {
    const auto margin_mm = [&](bool is_high) {
      return voxel_mm * (ends_flat(skin_L, box, axis, is_high) ? -kCutOff_voxels : kAir_voxels);
    };
    grid.origin_L[axis] = box.min()[axis] - margin_mm(false);
    const double length_mm = box.max()[axis] + margin_mm(true) - grid.origin_L[axis];
    grid.size[std::size_t(axis)] = std::max<Index>(Index(length_mm / voxel_mm) + 1, 2);
    voxels *= double(grid.size[std::size_t(axis)]);
  }
  if (voxels > kMaxVoxels)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("a grid of {:g} mm voxels around the skin has {:.1e} voxels, must have "
                            "{:.0e} or fewer",
                            voxel_mm, voxels, kMaxVoxels));
  return grid;
}

/// Distance to a surface in voxels, negative inside, clamped to the band.
image::ScalarVolume distances_of(const TriangleMesh& surface_L, const image::Grid& grid) {
  const geometry::Bvh tree(surface_L);
  const double voxel_mm = grid.spacing_mm.x(), band_mm = kBand_voxels * voxel_mm;
  // In general position, so that the ray passes through no edge of a regular surface.
  const Vec3 ray(0.0123456, 0.0234567, 1.0);
  image::ScalarVolume distances{grid, std::vector<float>(std::size_t(grid.voxel_count()))};
  parallel_for(grid.size[1] * grid.size[2], [&](Index line) {
    const Index j = line % grid.size[1], k = line / grid.size[1];
    bool is_inside = false;
    for (Index i = 0; i < grid.size[0]; ++i) {
      const Vec3 p_L = grid.point_L({double(i), double(j), double(k)});
      const bool is_near = tree.closest_point(p_L, band_mm).has_value();
      double distance_mm = band_mm;
      if (is_near) {
        distance_mm = tree.signed_distance(p_L).distance_mm;
        is_inside = distance_mm < 0.0;
      } else {
        // Beyond the band the side is that of the voxel before: no surface lies between them.
        if (i == 0) is_inside = tree.count_hits(p_L, ray) % 2 == 1;
        if (is_inside) distance_mm = -band_mm;
      }
      distances.at(i, j, k) = float(distance_mm / voxel_mm);
    }
  });
  return distances;
}

/// CT number at a border: linear, with the threshold on the surface.
double hu_at_border(double distance_voxels, double threshold_hu, double outside_hu,
                    double inside_hu) {
  const double slope_hu =
      2.0 * (threshold_hu < 0.0 ? inside_hu - threshold_hu : threshold_hu - outside_hu);
  return std::clamp(threshold_hu - slope_hu * distance_voxels, outside_hu, inside_hu);
}

struct HeadDistances {
  image::ScalarVolume skin, skull;
  std::optional<image::ScalarVolume> mandible;
};

LabeledScan labeled(const HeadDistances& at) {
  const image::Grid& grid = at.skin.grid;
  const auto count = std::size_t(grid.voxel_count());
  LabeledScan head{{grid, std::vector<std::int16_t>(count)}, {grid, std::vector<Tissue>(count)}};
  parallel_for(
      grid.voxel_count(),
      [&](Index index) {
        const auto v = std::size_t(index);
        const double skin = at.skin.values[v], skull = at.skull.values[v];
        const double mandible = at.mandible ? double(at.mandible->values[v]) : kBand_voxels;
        const double bone = std::min(skull, mandible);
        double hu = hu_at_border(skin, kSkinThreshold_hu, kOutside_hu, kTissue_hu);
        if (bone < 0.5)
          hu = std::max(hu, hu_at_border(bone, kBoneThreshold_hu, kTissue_hu, kCortical_hu));
        head.ct.values[v] = std::int16_t(std::lround(hu));
        Tissue& tissue = head.labels.values[v];
        tissue = skin < 0.0 ? Tissue::kSoftTissue : Tissue::kBackground;
        if (skull < 0.0) tissue = Tissue::kBone;
        if (mandible < 0.0) tissue = Tissue::kMandible;
      },
      65536);
  return head;
}

void label_brain(LabelMap& labels) {
  const auto where = [&](auto belongs) {
    return mask_where(labels.grid, [&](std::size_t v) { return belongs(labels.values[v]); });
  };
  const Mask brain = find_brain(where([](Tissue t) { return t == Tissue::kSoftTissue; }),
                                where([](Tissue t) { return is_bone(t); }),
                                where([](Tissue t) { return t == Tissue::kBackground; }));
  for (std::size_t v = 0; v < labels.values.size(); ++v)
    if (brain.values[v] != 0) labels.values[v] = Tissue::kBrain;
}

}  // namespace

Result<LabeledScan> scan_from_surfaces(const HeadSurfaces& surfaces, double voxel_mm,
                                       Progress& progress) {
  if (!(voxel_mm > 0.0) || !std::isfinite(voxel_mm))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the voxel size is {:g} mm, must be positive", voxel_mm));
  LEFORT_TRY(const TriangleMesh skin_L, checked_surface(surfaces.skin_L, "skin"));
  LEFORT_TRY(const TriangleMesh skull_L, checked_surface(surfaces.skull_L, "skull"));
  LEFORT_TRY(const image::Grid grid, grid_around(skin_L, voxel_mm));
  progress.begin_stage("voxelize the surfaces");
  HeadDistances at{distances_of(skin_L, grid), distances_of(skull_L, grid), std::nullopt};
  progress.report(0.6);
  if (surfaces.mandible_L) {
    LEFORT_TRY(const TriangleMesh mandible_L, checked_surface(*surfaces.mandible_L, "mandible"));
    at.mandible = distances_of(mandible_L, grid);
  }
  if (progress.stop_requested())
    return fail(ErrorCode::kCancelled, "voxelizing the surfaces was stopped");
  LabeledScan head = labeled(at);
  const auto& values = head.labels.values;
  if (std::none_of(values.begin(), values.end(), [](Tissue t) { return is_bone(t); }))
    return fail(ErrorCode::kAnatomyMissing,
                "no bone lies inside the box of the skin: are all surfaces in one frame?");
  label_brain(head.labels);
  return head;
}

}  // namespace lefort::anatomy
