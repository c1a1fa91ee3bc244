/// \file
/// Volume and cross-sections of the pharyngeal airway.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/image/volume.h>

#include <cstddef>
#include <vector>

namespace lefort::anatomy {

/// Where the measured airway ends. Air anterior to the front is nose or mouth.
struct AirwayLimits {
  Vec3 upper_L;     ///< A point of the upper plane.
  Vec3 lower_L;     ///< A point of the lower plane.
  Vec3 front_L;     ///< A point of the coronal plane in front of the airway.
  Vec3 superior_L;  ///< Normal of upper and lower plane; unit length.
  Vec3 anterior_L;  ///< Normal of the front; unit length, perpendicular to `superior_L`.
};

/// A section normal to the center line.
struct AirwaySection {
  double along_mm = 0.0;  ///< Length of the center line from the upper end.
  Vec3 center_L = Vec3::Zero();
  Vec3 normal_L = Vec3::UnitZ();  ///< Along the center line, to inferior.
  double area_mm2 = 0.0;          ///< Of the air that is connected with the center.
  double width_mm = 0.0;          ///< Left to right.
  double depth_mm = 0.0;          ///< In the other direction of the section.
};

struct Airway {
  double volume_ml = 0.0;
  double length_mm = 0.0;               ///< Of the center line.
  double closed_mm = 0.0;               ///< Length of the center line without air.
  std::vector<AirwaySection> sections;  ///< From superior to inferior, 1 mm from each other.
  std::size_t min_section = 0;          ///< The one with the smallest area.
  std::vector<AirwaySection> axial;     ///< The same, parallel to the limits.
  std::size_t min_axial = 0;
  /// 0.5 minus the fraction of tissue, on a part of the grid of the scan; positive in the airway.
  image::ScalarVolume level;
};

/// Measures the airway between the limits: all of its connected parts of 0.1 ml or more. Where the
/// airway is closed, the center line passes through tissue, and its sections have no area.
///
/// The fraction of air in a voxel at the wall is linear in the CT number, from -1000 HU in air to
/// 40 HU in the mucosa. The volume is the sum of the fractions. The center line is the minimal path
/// for a speed that grows with the square of the distance to the wall \cite deschamps2001. Its
/// sections are the connected areas where the interpolated fraction exceeds one half, on a lattice
/// of 0.25 mm.
///
/// \param ct      the scan.
/// \param labels  with the airway. \pre on the grid of `ct`.
/// \param limits  in frame L.
/// \returns the airway; or kInvalidArgument if the upper limit is not 5 mm or more above the
///   lower one; or
///   kAnatomyMissing if there is less than 0.1 ml of air between the limits.
[[nodiscard]] Result<Airway> measure_airway(const image::CtVolume& ct, const LabelMap& labels,
                                            const AirwayLimits& limits);

}  // namespace lefort::anatomy
