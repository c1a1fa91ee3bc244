/// \file
/// A head made of formulas: what a scanner would show of it, and what every voxel truly is.
///
/// For trying lefort without a patient, and for tests. Life-size and asymmetric on purpose:
///   - patient's left:  the nose leans there; a large maxillary sinus; a thick mandibular ramus;
///   - patient's right: a hole of the frontal bone; a small maxillary sinus; a thin ramus.
/// The mandible and the column of the neck touch no other bone; a head holder lies behind.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/image/volume.h>

#include <cstdint>

namespace lefort::anatomy {

/// Signed distances to the surfaces of the synthetic head, exact to first order near zero [mm]:
/// positive *inside*, as levels are (tissue_levels.h). `p_L` in mm; the origin lies in the head.
namespace synthetic {
[[nodiscard]] double skin(const Vec3& p_L);   ///< All of the head, airway and sinuses too.
[[nodiscard]] double skull(const Vec3& p_L);  ///< Cranium and maxilla, with the sinuses.
[[nodiscard]] double mandible(const Vec3& p_L);
[[nodiscard]] double column(const Vec3& p_L);  ///< The bone of the neck.
[[nodiscard]] double brain(const Vec3& p_L);
[[nodiscard]] double airway(const Vec3& p_L);  ///< Nostril, nose and pharynx.
[[nodiscard]] double sinuses(const Vec3& p_L);
[[nodiscard]] double holder(const Vec3& p_L);
}  // namespace synthetic

/// CT numbers of its materials [HU]: typical of air, soft tissue, and cortical bone.
struct SyntheticMaterials {
  double air_hu = -1000.0;
  double soft_hu = 40.0;
  double bone_hu = 900.0;
  double holder_hu = 200.0;
  double noise_hu = 12.0;  ///< Standard deviation; the same numbers for the same grid.
};

/// A grid of cubes of about `voxel_mm` over the head and its holder, axes along L.
[[nodiscard]] image::Grid synthetic_grid(double voxel_mm);

/// The tissue at a point.
[[nodiscard]] Tissue synthetic_tissue(const Vec3& p_L);

/// The tissue at each voxel's center.
[[nodiscard]] LabelMap synthetic_labels(const image::Grid& grid);

/// What a scanner makes of the head: in each voxel the mean over its box, and noise.
///
/// \param grid  any, a single oblique slice too.
/// \param seed  of the noise; slices of one scan take different ones.
[[nodiscard]] image::CtVolume synthetic_scan(const image::Grid& grid,
                                             const SyntheticMaterials& materials = {},
                                             std::uint64_t seed = 1);

}  // namespace lefort::anatomy
