/// \file
/// A synthetic head, defined by formulas: its CT scan, and the true tissue of each voxel.
///
/// For demonstrations without patient data, and for tests. Life-size, and asymmetric on purpose:
///   - patient's left:  the nose deviates to this side; a large maxillary sinus; a thick ramus;
///   - patient's right: a hole in the frontal bone; a small maxillary sinus; a thin ramus.
/// The mandible and the cervical spine touch no other bone; behind the head there is a head holder.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/image/volume.h>

#include <cstdint>

namespace lefort::anatomy {

/// Level-set functions of the synthetic head [mm], exact to first order near zero: positive inside
/// (tissue_levels.h).
///
/// \param p_L  a point [mm]; the origin is inside the head.
namespace synthetic {
[[nodiscard]] double skin(const Vec3& p_L);   ///< The whole head, including airway and sinuses.
[[nodiscard]] double skull(const Vec3& p_L);  ///< Cranium and maxilla, including sinuses.
[[nodiscard]] double mandible(const Vec3& p_L);
[[nodiscard]] double column(const Vec3& p_L);  ///< The cervical spine.
[[nodiscard]] double brain(const Vec3& p_L);
[[nodiscard]] double airway(const Vec3& p_L);  ///< Nostril, nose and pharynx.
[[nodiscard]] double sinuses(const Vec3& p_L);
[[nodiscard]] double holder(const Vec3& p_L);  ///< The head holder.
}  // namespace synthetic

/// CT numbers of the materials [HU], typical of air, soft tissue and cortical bone.
struct SyntheticMaterials {
  double air_hu = -1000.0;
  double soft_hu = 40.0;
  double bone_hu = 900.0;
  double holder_hu = 200.0;
  double noise_hu = 12.0;  ///< Standard deviation of noise; reproducible for equal grid and seed.
};

/// A grid of cubes of `voxel_mm` over the head and its holder, axes along L.
[[nodiscard]] image::Grid synthetic_grid(double voxel_mm);

/// The tissue at a point.
[[nodiscard]] Tissue synthetic_tissue(const Vec3& p_L);

/// The tissue at the center of each voxel.
[[nodiscard]] LabelMap synthetic_labels(const image::Grid& grid);

/// Simulates a scan: the mean CT number of each voxel, plus noise.
///
/// \param grid       any grid, including a single oblique slice.
/// \param materials  CT numbers.
/// \param seed       of the noise; slices of one scan must have different seeds.
[[nodiscard]] image::CtVolume synthetic_scan(const image::Grid& grid,
                                             const SyntheticMaterials& materials = {},
                                             std::uint64_t seed = 1);

}  // namespace lefort::anatomy
