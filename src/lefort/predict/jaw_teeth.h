/// \file
/// The teeth of both jaws as objects: axis, edge, and border of crown and root. Interface and lips
/// use them. Described in docs/theory/interface.md.
#pragma once

#include <lefort/core/types.h>
#include <lefort/image/volume.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace lefort::predict {

/// One tooth.
struct JawTooth {
  int fdi = 0;                   ///< Number of the FDI (ISO 3950), 11 to 48.
  Vec3 axis_L = Vec3::UnitZ();   ///< Unit vector of the long axis, from the root to the crown.
  Vec3 along_L = Vec3::UnitX();  ///< Unit vector along the arch, perpendicular to the axis.
  Vec3 tip_L = Vec3::Zero();     ///< Incisal edge or cusps: on the axis, at their height.
  Vec3 border_L = Vec3::Zero();  ///< Cemento-enamel junction, on the axis.
  double half_width_mm = 0.0;    ///< Of the crown along the arch.
  double edge_z_mm = 0.0;        ///< z of the edge: lowest of an upper, highest of a lower tooth.

  [[nodiscard]] bool is_lower() const { return fdi >= 30; }
  /// Incisor or canine.
  [[nodiscard]] bool is_anterior() const { return fdi % 10 <= 3; }
  [[nodiscard]] bool is_incisor() const { return fdi % 10 <= 2; }
  /// Height above the border along the axis [mm]: positive on the crown.
  [[nodiscard]] double height_mm(const Vec3& p_L) const { return axis_L.dot(p_L - border_L); }
};

/// Teeth with the voxels that they were found from.
struct JawTeeth {
  image::Volume<std::uint8_t> numbers;  ///< FDI number of each voxel, 0 elsewhere.
  std::vector<JawTooth> teeth;          ///< By number.

  /// \returns the tooth whose part of the arch a point of its jaw lies in: at most 1.5 mm beyond
  ///   its crown along the arch, and 15 mm beside its axis across the arch. Null in a gap.
  [[nodiscard]] const JawTooth* tooth_at(const Vec3& p_L, bool on_mandible) const;
  /// \returns whether a point lies within 2 mm of the crown of its tooth, or of that of the other
  ///   jaw.
  [[nodiscard]] bool is_on_crown(const Vec3& p_L) const;
  /// \returns the level of the edges of a jaw's anterior teeth: the median of its incisors, or
  ///   without two of them of incisors and canines. Nothing with fewer than two.
  [[nodiscard]] std::optional<double> edge_z_mm(bool of_mandible) const;
};

/// Height of a crown from the cemento-enamel junction to the incisal edge or the cusps, by FDI
/// number: means of \cite nelson2015. \pre fdi % 10 is 1 to 8.
[[nodiscard]] double crown_height_mm(int fdi);

/// Length of a tooth, crown and root, as crown_height_mm().
[[nodiscard]] double tooth_length_mm(int fdi);

/// Finds axis, edge and border of each tooth.
///
/// The axis is the direction of the largest variance of the voxels; where it lies more than 53
/// degrees from z (a molar without roots), the axis is z. The border lies behind the edge by the
/// mean height of the crown, times the length of the tooth relative to its mean (0.7 to 1.1: less
/// is a root that was not found): enamel does not end visibly beside metal, and the alveolar crest
/// does not in a scan of clinical resolution (docs/studies/interface.md).
///
/// \param numbers  FDI number of each voxel; values that are no number of a permanent tooth, and
///   teeth of less than 30 mm3, are left out.
[[nodiscard]] JawTeeth find_jaw_teeth(image::Volume<std::uint8_t> numbers);

}  // namespace lefort::predict
