/// \file
/// Tissue labels of voxels.
#pragma once

#include <lefort/image/volume.h>

#include <array>
#include <cstdint>

namespace lefort::anatomy {

/// The values stored in a label map and in our `.seg.nrrd` files.
enum class Tissue : std::uint8_t {
  kBackground = 0,  ///< Outside the patient: air, table, head holder.
  kBone = 1,        ///< Skull and other bone; also the mandible if it cannot be separated.
  kSoftTissue = 2,  ///< Facial and other soft tissue outside the cranial cavity.
  kAirway = 3,      ///< Air inside the patient that is no sinus: nose, pharynx, mouth.
  kBrain = 4,       ///< All soft tissue inside the cranial cavity.
  kSinus = 5,       ///< Air with bony walls: paranasal sinuses, mastoid cells.
  kMandible = 6,    ///< With its teeth, if it can be separated from the skull.
  kMuscle = 7,      ///< Labeled by the user; not segmented automatically.
};

[[nodiscard]] constexpr bool is_bone(Tissue tissue) {
  return tissue == Tissue::kBone || tissue == Tissue::kMandible;
}

/// True for soft tissue and muscle: they differ in material only, not in surfaces.
[[nodiscard]] constexpr bool is_soft_tissue(Tissue tissue) {
  return tissue == Tissue::kSoftTissue || tissue == Tissue::kMuscle;
}

/// Name and color of a tissue in files and pictures.
struct TissueStyle {
  Tissue tissue;
  const char* name;
  std::array<double, 3> color;  ///< RGB, 0 to 1.
};

inline constexpr std::array<TissueStyle, 7> kTissueStyles{{
    {Tissue::kBone, "bone", {0.95, 0.84, 0.57}},
    {Tissue::kSoftTissue, "soft tissue", {0.69, 0.48, 0.40}},
    {Tissue::kAirway, "airway", {0.56, 0.80, 0.91}},
    {Tissue::kBrain, "brain", {0.98, 0.98, 0.88}},
    {Tissue::kSinus, "sinus", {0.37, 0.62, 0.76}},
    {Tissue::kMandible, "mandible", {0.87, 0.72, 0.44}},
    {Tissue::kMuscle, "muscle", {0.75, 0.41, 0.35}},
}};

/// One label per voxel, on the grid of the scan.
using LabelMap = image::Volume<Tissue>;

}  // namespace lefort::anatomy
