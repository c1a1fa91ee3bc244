#include <lefort/anatomy/find_mandible.h>
#include <lefort/anatomy/find_occlusal_planes.h>
#include <lefort/anatomy/pad_volume.h>
#include <lefort/anatomy/seeded_watershed.h>

#include <array>
#include <cmath>
#include <vector>

namespace lefort::anatomy {
namespace {

// Lower limits; a child's mandible has 25 ml of bone, is 80 mm wide and 70 mm deep, but the scan
// may truncate it below.
constexpr double kMin_ml = 10.0;
constexpr double kMinWidth_mm = 50.0;
constexpr double kMinDepth_mm = 30.0;
// With its rami; the lower limit of the height if the mandible had to be separated.
constexpr double kMinHeight_mm = 45.0;
// Upper limit with teeth and metal; adults have 50 to 110 ml.
constexpr double kMax_ml = 150.0;
// The chin lies in this frontal fraction of the length of the skull.
constexpr double kFront = 0.3;
// Largest distance of its middle from that of the skull, as a fraction of the width of the skull,
// about 150 mm. A clavicle or a shoulder lies further to the side.
constexpr double kMaxOffset = 0.15;

// Seeds keep this distance from the occlusal plane: the overbite, and curved occlusal surfaces.
constexpr double kOcclusion_mm = 5.0;
// The maxilla lies up to this height above the plane, the skull without the condyles from that.
constexpr double kMaxilla_mm = 20.0;
constexpr double kSkullBase_mm = 65.0;
// The angles of the mandible are as far posterior as the condyles or this much less.
constexpr double kBehind_mm = 15.0;
// The neck and the back of the head below this are not near the joints.
constexpr double kBelow_mm = 30.0;
// What may contain the mandible: its distance from the front and from the middle.
constexpr double kDepth_mm = 150.0;
constexpr double kHalfWidth_mm = 90.0;
// Bone of a joint space is less dense than this multiple of the threshold of bone ...
constexpr double kDensity = 2.0;
// Half the width of the foramina, and the height of a crown.
constexpr double kForamen_mm = 2.0;
constexpr double kCrownHeight_mm = 10.0;
// ... and bone deeper than this is marrow, and remains whatever its density.
constexpr double kMarrow_mm = 3.0;

enum Side : std::int32_t { kNeither = 0, kLower = 1, kUpper = 2 };

/// Bounding boxes of the components in L.
std::vector<Box3> boxes_of(const Components& parts) {
  std::vector<Box3> boxes(parts.voxels.size());
  const image::Grid& grid = parts.component_of.grid;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        if (const std::int32_t part = parts.component_of.at(i, j, k); part != 0)
          boxes[std::size_t(part)].extend(grid.point_L({double(i), double(j), double(k)}));
  return boxes;
}

/// Whether a box lies as the mandible does: not wider than the skull, between its sides, as far to
/// the front, below its center, and up to it.
bool lies_as_mandible(const Box3& box, const Box3& skull) {
  const bool in_the_middle =
      std::abs(box.center().x() - skull.center().x()) < kMaxOffset * skull.sizes().x() &&
      box.sizes().x() < skull.sizes().x();
  const bool in_front = box.min().y() < skull.min().y() + kFront * skull.sizes().y();
  const bool below = box.center().z() < skull.center().z();
  const bool up_to_skull = box.max().z() > skull.min().z();
  return in_the_middle && in_front && below && up_to_skull;
}

bool is_as_large(const Box3& box, Index voxels, const image::Grid& grid) {
  const Vec3 size_mm = box.sizes();
  return double(voxels) * voxel_ml(grid) >= kMin_ml && size_mm.x() >= kMinWidth_mm &&
         size_mm.y() >= kMinDepth_mm;
}

/// The component that is the mandible; 0 if there is none.
std::int32_t jaw_among(const Components& parts) {
  const std::vector<Box3> boxes = boxes_of(parts);
  const std::int32_t skull = parts.largest();
  const Box3& head = boxes[std::size_t(skull)];
  std::int32_t jaw = 0;
  for (std::int32_t part = 1; part <= parts.count(); ++part) {
    const Box3& box = boxes[std::size_t(part)];
    const Index voxels = parts.voxels[std::size_t(part)];
    if (part == skull || !is_as_large(box, voxels, parts.component_of.grid)) continue;
    const bool larger = jaw == 0 || voxels > parts.voxels[std::size_t(jaw)];
    if (lies_as_mandible(box, head) && larger) jaw = part;
  }
  return jaw;
}

Mask component(const Components& parts, std::int32_t part) {
  return mask_where(parts.component_of.grid,
                    [&](std::size_t v) { return parts.component_of.values[v] == part; });
}

bool is_plausible(const Mask& mandible) {
  const double ml = double(voxel_count(mandible)) * voxel_ml(mandible.grid);
  return ml >= kMin_ml && ml <= kMax_ml;
}

Mask none(const image::Grid& grid) {
  return mask_where(grid, [](std::size_t) { return false; });
}

/// Points of the voxels of a grid, by offset.
struct Points {
  const image::Grid& grid;

  [[nodiscard]] Vec3 operator()(std::size_t v) const {
    const Index i = Index(v) % grid.size[0], jk = Index(v) / grid.size[0];
    const Index j = jk % grid.size[1], k = jk / grid.size[1];
    return grid.point_L({double(i), double(j), double(k)});
  }
};

/// What lies outside of the box that contains the mandible and the skull around it.
Margin around_jaws(const Mask& bone, const OcclusalPlane& plane) {
  const Points point_L{bone.grid};
  return margin_around(bone.grid, {0, 0, 0}, [&](std::size_t v) {
    if (bone.values[v] == 0) return false;
    const Vec3 p_L = point_L(v);
    return std::abs(p_L.x() - plane.front_L.x()) < kHalfWidth_mm &&
           p_L.y() < plane.front_L.y() + kDepth_mm &&
           plane.height_mm(p_L) < kSkullBase_mm + kMaxilla_mm &&
           plane.height_mm(p_L) > -kSkullBase_mm - kMaxilla_mm;
  });
}

/// The body of the mandible with the lower parts of its rami: the largest component below the
/// plane that is as wide and deep as a mandible and contains the chin; empty if there is none.
Mask body_below(const Mask& bone, const OcclusalPlane& plane) {
  const Points point_L{bone.grid};
  const Components parts = connected_components(
      mask_where(bone.grid,
                 [&](std::size_t v) {
                   return bone.values[v] != 0 && plane.height_mm(point_L(v)) < -kOcclusion_mm;
                 }),
      Neighbors::kFacesEdgesCorners);
  const std::vector<Box3> boxes = boxes_of(parts);
  std::int32_t body = 0;
  for (std::int32_t part = 1; part <= parts.count(); ++part) {
    const Box3& box = boxes[std::size_t(part)];
    const Index voxels = parts.voxels[std::size_t(part)];
    const double to_side_mm = std::abs(box.center().x() - plane.front_L.x());
    const bool in_front = box.min().y() < plane.front_L.y() + kMinDepth_mm;
    if (!is_as_large(box, voxels, bone.grid) || !in_front || to_side_mm > kMinDepth_mm) continue;
    if (body == 0 || voxels > parts.voxels[std::size_t(body)]) body = part;
  }
  return body == 0 ? none(bone.grid) : component(parts, body);
}

/// Seeds of the mandible, its body, and of the skull: the maxilla, what lies above the joints, and
/// what lies behind them.
image::Volume<std::int32_t> seeds_around(const Mask& bone, const Mask& body,
                                         const OcclusalPlane& plane) {
  const Points point_L{bone.grid};
  Box3 box;
  for (std::size_t v = 0; v < body.values.size(); ++v)
    if (body.values[v] != 0) box.extend(point_L(v));
  image::Volume<std::int32_t> seeds{bone.grid,
                                    std::vector<std::int32_t>(bone.values.size(), kNeither)};
  parallel_for(Index(bone.values.size()), [&](Index n) {
    const auto v = std::size_t(n);
    if (bone.values[v] == 0) return;
    const Vec3 p_L = point_L(v);
    const double height_mm = plane.height_mm(p_L);
    const bool maxilla =
        plane.is_in_arch_column(p_L) && height_mm > kOcclusion_mm && height_mm < kMaxilla_mm;
    const bool above = height_mm > kSkullBase_mm;
    const bool behind = p_L.y() > box.max().y() + kBehind_mm && height_mm > -kBelow_mm;
    if (body.values[v] != 0)
      seeds.values[v] = kLower;
    else if (maxilla || above || behind)
      seeds.values[v] = kUpper;
  });
  return seeds;
}

/// Half the width of dense bone with the marrow it encloses.
image::ScalarVolume dense_width(const image::CtVolume& ct, const Mask& bone, double bone_hu) {
  // Of HU below zero a multiple would be no increase.
  const double min_hu = bone_hu + (kDensity - 1.0) * std::abs(bone_hu);
  const auto is_sparse = [&](std::size_t v) {
    return bone.values[v] == 0 || double(ct.values[v]) < min_hu;
  };
  const Components sparse =
      connected_components(mask_where(bone.grid, is_sparse), Neighbors::kFaces);
  const std::vector<std::uint8_t> is_open = components_overlapping(
      sparse, mask_where(bone.grid, [&](std::size_t v) { return bone.values[v] == 0; }));
  const image::ScalarVolume depth_mm =
      distance_to(mask_where(bone.grid, [&](std::size_t v) { return bone.values[v] == 0; }));
  const Mask open = select_components(sparse, is_open);
  return distance_to(mask_where(bone.grid, [&](std::size_t v) {
    return open.values[v] != 0 && (bone.values[v] == 0 || double(depth_mm.values[v]) <= kMarrow_mm);
  }));
}

/// Adds the marrow: soft tissue that the mandible encloses when openings up to twice as wide as
/// kForamen_mm are closed, but not the gaps between the crowns.
void add_marrow(const Mask& bone, const OcclusalPlane& plane, Mask& mandible) {
  const Mask tight = dilated(mandible, kForamen_mm);
  const Components rooms = connected_components(
      mask_where(bone.grid, [&](std::size_t v) { return tight.values[v] == 0; }),
      Neighbors::kFaces);
  const std::int32_t outside = rooms.largest();
  const image::ScalarVolume to_outside = distance_to(mask_where(
      bone.grid, [&](std::size_t v) { return rooms.component_of.values[v] == outside; }));
  const Points point_L{bone.grid};
  mandible = mask_where(bone.grid, [&](std::size_t v) {
    if (mandible.values[v] != 0) return true;
    if (bone.values[v] != 0 || double(to_outside.values[v]) <= kForamen_mm) return false;
    const Vec3 p_L = point_L(v);
    return !plane.is_in_arch_column(p_L) || plane.height_mm(p_L) < -kCrownHeight_mm;
  });
}

/// The mandible below and above the plane; empty if there is none.
Mask separated_at(const image::CtVolume& ct, const Mask& bone, double bone_hu,
                  const OcclusalPlane& plane) {
  Mask body = body_below(bone, plane);
  if (voxel_count(body) == 0) return body;
  const auto basins =
      seeded_watershed(seeds_around(bone, body, plane), bone, dense_width(ct, bone, bone_hu));
  const Components parts = connected_components(
      mask_where(bone.grid, [&](std::size_t v) { return basins.values[v] == kLower; }),
      Neighbors::kFacesEdgesCorners);
  Mask mandible = component(parts, parts.largest());
  add_marrow(bone, plane, mandible);
  const double height_mm = boxes_of(parts)[std::size_t(parts.largest())].sizes().z();
  return height_mm >= kMinHeight_mm ? mandible : none(bone.grid);
}

}  // namespace

Mask find_mandible(const image::CtVolume& ct, const Mask& bone, double bone_hu) {
  {
    const Components parts = connected_components(bone, Neighbors::kFacesEdgesCorners);
    if (parts.count() > 1)
      if (const std::int32_t jaw = jaw_among(parts); jaw != 0)
        if (Mask mandible = component(parts, jaw); is_plausible(mandible)) return mandible;
  }
  Mask mandible = none(bone.grid);
  const Index bone_voxels = voxel_count(bone);
  for (const OcclusalPlane& plane : find_occlusal_planes(ct, bone, bone_hu)) {
    const Margin margin = around_jaws(bone, plane);
    const Mask part = separated_at(cropped(ct, margin), cropped(bone, margin), bone_hu, plane);
    const bool is_smaller_than_skull = 2 * voxel_count(part) < bone_voxels;
    if (!is_plausible(part) || !is_smaller_than_skull) continue;
    paste(part, margin, mandible);
    break;
  }
  return mandible;
}

}  // namespace lefort::anatomy
