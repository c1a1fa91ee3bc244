/// \file
/// What each voxel of a scan is.
#pragma once

#include <lefort/image/volume.h>

#include <array>
#include <cstdint>

namespace lefort::anatomy {

/// The values stored in a label map and in our `.seg.nrrd` files.
enum class Tissue : std::uint8_t {
  kBackground = 0,  ///< Outside the patient: air, table, head holder.
  kBone = 1,        ///< All but the mandible, where that is told apart.
  kSoftTissue = 2,  ///< Facial and other soft tissue outside the cranial cavity.
  kAirway = 3,      ///< Air inside the patient that reaches the outside: nose, pharynx.
  kBrain = 4,       ///< Everything soft inside the cranial cavity.
  kSinus = 5,       ///< Air enclosed by bone: maxillary, frontal, sphenoid, mastoid cells.
  kMandible = 6,    ///< Where the scan shows it apart from the skull.
  kMuscle = 7,      ///< Soft tissue that somebody named so; no rule finds it.
};

[[nodiscard]] constexpr bool is_bone(Tissue tissue) {
  return tissue == Tissue::kBone || tissue == Tissue::kMandible;
}

/// What surfaces and levels take as one; muscle differs by its material alone.
[[nodiscard]] constexpr bool is_soft_tissue(Tissue tissue) {
  return tissue == Tissue::kSoftTissue || tissue == Tissue::kMuscle;
}

/// How a tissue is called and colored in files and pictures.
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

/// One label per voxel of the scan, on the scan's own grid.
using LabelMap = image::Volume<Tissue>;

}  // namespace lefort::anatomy
