/// \file
/// Finds the gap between the upper and the lower jaw.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

#include <vector>

namespace lefort::anatomy {

/// A plane that may lie between the teeth of both jaws, or between toothless jaws.
struct OcclusalPlane {
  Vec3 normal_L{0.0, 0.0, 1.0};  ///< Unit vector, to superior.
  double offset_mm = 0.0;        ///< normal . p on the plane.
  Vec3 front_L{0.0, 0.0,
               0.0};  ///< Most anterior bone of the face, in the middle; not on the plane.
  /// 1 if the plane crosses no bone of the dental arches, 0 if it crosses as much as the densest
  /// parallel plane of the jaw with less bone.
  double contrast = 0.0;
  bool is_of_enamel = false;  ///< Fitted to the crowns; `contrast` is set to 1.

  /// Signed distance of a point, positive superior to the plane.
  [[nodiscard]] double height_mm(const Vec3& p_L) const { return normal_L.dot(p_L) - offset_mm; }
  /// Whether a point is in the column of the dental arches, from the lips to the last molars, or
  /// within a margin around it.
  [[nodiscard]] bool is_in_arch_column(const Vec3& p_L, double margin_mm = 0.0) const;
};

/// Planes between the jaws, the one with the most contrast first; empty if the scan does not show
/// both jaws.
///
/// Gap valley detection (\cite jain2004) in three dimensions: the density of bone is summed over
/// planes through the column of the dental arches; the gap is the deepest valley of the sums along
/// the normal. Pitch and roll of the planes are varied, as the head may be tilted. Teeth in
/// occlusion leave no gap. If there is enamel, the first plane is therefore the least-squares plane
/// through the enamel, which lies between the crowns of both jaws.
///
/// \param ct       the scan.
/// \param bone     all bone. \pre on the grid of `ct`.
/// \param bone_hu  threshold of bone.
[[nodiscard]] std::vector<OcclusalPlane> find_occlusal_planes(const image::CtVolume& ct,
                                                              const Mask& bone, double bone_hu);

}  // namespace lefort::anatomy
