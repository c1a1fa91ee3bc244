/// \file
/// Painted labels of the tissue boundary; they override the boundary rules.
#pragma once

#include <lefort/image/volume.h>

#include <array>
#include <cstdint>

namespace lefort::predict {

/// Boundary condition of a voxel.
enum class BoundaryLabel : std::uint8_t {
  kNone = 0,  ///< Not painted: the boundary rules decide.
  kFixed = 1,
  kFree = 2,         ///< Not fixed; a segment may push it, with the clinical interface any bone.
  kWithSegment = 3,  ///< Moves with the closest segment, even if not on it.
  kContact = 4,      ///< Free; stationary bone pushes it too.
  kBonded = 5,       ///< Moves with the closest bone.
  kElevated = 6,     ///< Not attached to the closest bone; bones push it.
  kSliding = 7,      ///< Stays on the closest bone and moves freely along it.
};

/// Name and color of a label in files, and the name of its node set.
struct BoundaryLabelStyle {
  BoundaryLabel label;
  const char* name;
  const char* set;
  std::array<double, 3> color;  ///< RGB, 0 to 1; safe for color blindness.
};

inline constexpr std::array<BoundaryLabelStyle, 7> kBoundaryLabelStyles{{
    {BoundaryLabel::kFixed, "fixed", "painted_fixed", {0.80, 0.25, 0.20}},
    {BoundaryLabel::kFree, "free", "painted_free", {0.06, 0.50, 0.47}},
    {BoundaryLabel::kWithSegment, "with segment", "painted_with_segment", {0.60, 0.35, 0.80}},
    {BoundaryLabel::kContact, "contact", "painted_contact", {0.90, 0.60, 0.00}},
    {BoundaryLabel::kBonded, "bonded", "painted_bonded", {0.00, 0.45, 0.70}},
    {BoundaryLabel::kElevated, "elevated", "painted_elevated", {0.34, 0.71, 0.91}},
    {BoundaryLabel::kSliding, "sliding", "painted_sliding", {0.94, 0.89, 0.26}},
}};

/// One label per voxel of the scan.
using BoundaryLabelMap = image::Volume<BoundaryLabel>;

/// Max distance from the center of a painted voxel at which its label applies: half the diagonal of
/// a voxel [mm].
[[nodiscard]] double max_paint_distance_mm(const image::Grid& grid);

/// \returns the label of the painted voxel whose center is closest to `p_L`, within
///   max_paint_distance_mm(); kNone if there is none. Of equally close voxels, the first of the
///   map.
[[nodiscard]] BoundaryLabel painted_at(const BoundaryLabelMap& painted, const Vec3& p_L);

}  // namespace lefort::predict
