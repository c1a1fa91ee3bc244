/// \file
/// What somebody painted that the tissue's boundary shall do, where the rule has it wrong.
#pragma once

#include <lefort/image/volume.h>

#include <array>
#include <cstdint>

namespace lefort::predict {

/// Sliding on a segment needs no label: tissue does so wherever it is free.
enum class BoundaryLabel : std::uint8_t {
  kNone = 0,  ///< Not painted: by rule.
  kFixed = 1,
  kFree = 2,         ///< Held by nothing; the segment may push it.
  kWithSegment = 3,  ///< Moves with the segment, wherever it lies.
  kSlides = 4,       ///< Free, but does not enter still bone: slides on it, and may come off.
};

/// How a label is called and colored in files, and the set of the nodes that it decides.
struct BoundaryLabelStyle {
  BoundaryLabel label;
  const char* name;
  const char* set;
  std::array<double, 3> color;  ///< RGB, 0 to 1; told apart by the color-blind as well.
};

inline constexpr std::array<BoundaryLabelStyle, 4> kBoundaryLabelStyles{{
    {BoundaryLabel::kFixed, "fixed", "painted_fixed", {0.80, 0.25, 0.20}},
    {BoundaryLabel::kFree, "free", "painted_free", {0.06, 0.50, 0.47}},
    {BoundaryLabel::kWithSegment, "with segment", "painted_with_segment", {0.60, 0.35, 0.80}},
    {BoundaryLabel::kSlides, "slides", "painted_slides", {0.90, 0.60, 0.00}},
}};

/// One label per voxel of the scan.
using BoundaryLabelMap = image::Volume<BoundaryLabel>;

/// How far a painted voxel's center may be from what it decides: half a voxel's diagonal [mm].
[[nodiscard]] double paint_reach_mm(const image::Grid& grid);

/// \returns the label of the nearest painted voxel, by its center, that is no further away than
///   paint_reach_mm(); kNone if there is none. Of several equally near the first of the map.
[[nodiscard]] BoundaryLabel painted_at(const BoundaryLabelMap& painted, const Vec3& p_L);

}  // namespace lefort::predict
