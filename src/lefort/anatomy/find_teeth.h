/// \file
/// Segments the teeth within the jaws.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/image/volume.h>

#include <array>
#include <cstdint>

namespace lefort::anatomy {

/// The values of a tooth map and of `teeth.seg.nrrd`.
enum class Tooth : std::uint8_t {
  kNone = 0,
  kUpper = 1,  ///< Within the label of bone.
  kLower = 2,  ///< Within the label of the mandible.
};

/// Name and color of the teeth of one jaw in files and pictures.
struct ToothStyle {
  Tooth tooth;
  const char* name;
  std::array<double, 3> color;  ///< RGB, 0 to 1.
};

inline constexpr std::array<ToothStyle, 2> kToothStyles{{
    {Tooth::kUpper, "upper teeth", {0.98, 0.97, 0.90}},
    {Tooth::kLower, "lower teeth", {0.90, 0.92, 0.98}},
}};

/// One value per voxel, on the grid of the scan. Teeth are bone in the label map, too: every tooth
/// voxel is labeled bone or mandible there.
using ToothMap = image::Volume<Tooth>;

/// Finds crowns and roots of both jaws; nothing if the mandible is not labeled.
///
/// Crowns are what lies close to the occlusal plane and is connected with enamel or metal, which
/// are denser than cortical bone. Roots are followed from them, as by \cite gao2010 from slice to
/// slice. A root is as dense as dentin, connected with a crown, within the footprint of the crowns
/// along the normal of the plane, and within the length of a root. Cortical bone may be as dense as
/// dentin; it is thinner, so an opening removes it.
///
/// \param ct       the scan.
/// \param labels   with the mandible. \pre on the grid of `ct`.
/// \param bone_hu  threshold of bone.
[[nodiscard]] ToothMap find_teeth(const image::CtVolume& ct, const LabelMap& labels,
                                  double bone_hu);

}  // namespace lefort::anatomy
