/// \file
/// Single teeth of a tooth map, with FDI numbers.
#pragma once

#include <lefort/anatomy/find_teeth.h>
#include <lefort/image/volume.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::dental {

/// Directions of the head and a point of its mid-sagittal plane.
struct DentalFrame {
  Vec3 left_L = Vec3::UnitX();
  Vec3 anterior_L = -Vec3::UnitY();
  Vec3 superior_L = Vec3::UnitZ();
  Vec3 midline_L = Vec3::Zero();
};

struct NumberedTooth {
  /// Number of the FDI (ISO 3950): quadrant 1 upper right, 2 upper left, 3 lower left, 4 lower
  /// right of the patient, then 1 (central incisor) to 8 (third molar).
  int fdi = 0;
  Vec3 crown_L = Vec3::Zero();  ///< Mean of the occlusal 6 mm.
  Vec3 apex_L = Vec3::Zero();   ///< Mean of the 5 % furthest from the crown along the axis.
  Vec3 axis_L = Vec3::UnitZ();  ///< Unit vector of the long axis, from the root to the crown.
  double length_mm = 0.0;       ///< Along the axis.
  double width_mm = 0.0;        ///< Of the crown along the arch (5 to 95 %).
  double volume_mm3 = 0.0;
};

struct NumberedTeeth {
  std::vector<NumberedTooth> teeth;  ///< By FDI number.
  /// FDI number of each voxel of the tooth map, 0 elsewhere and in parts that are no tooth.
  image::Volume<std::uint8_t> numbers;
  /// Numbers without a tooth, except third molars.
  std::vector<int> missing;
};

/// Separates and numbers the teeth.
///
/// 1. Watershed of the distance to the surface (\cite beucher1993), from its maxima with a dynamic
///    of 0.5 mm or more (\cite grimaud1992): adjacent crowns touch in a narrow area, a crown and
///    its roots do not. Parts without a crown and parts below 60 mm3 join the neighbor with the
///    largest common area; so do parts that lie side by side across the arch.
/// 2. Each part has a center and a width along the arch, a curve through the medians of its crowns
///    in sectors.
/// 3. A part of 9 mm or more that gets no number in step 4 is divided where its crown is thinnest
///    between 30 and 70 % of its width.
/// 4. Numbers minimize, by dynamic programming over parts and positions in order, the squared
///    deviations of widths (1.5 mm; bounded for narrow parts), of distances between neighbors
///    (2 mm, more across missing teeth), of positions from the middle of the jaw (3 mm), and of
///    that middle from the mid-sagittal plane (4 mm, at most 10 mm), with costs of missing teeth
///    and of parts that are no tooth. Means are the crown widths of \cite nelson2010.
///
/// \param teeth  crowns and roots of both jaws.
/// \param frame  of the head.
/// \note The constants were chosen with `jaws_and_teeth_labels`.
[[nodiscard]] NumberedTeeth number_teeth(const anatomy::ToothMap& teeth, const DentalFrame& frame);

/// \returns the FDI numbers without a tooth, except third molars.
[[nodiscard]] std::vector<int> missing_numbers(std::span<const NumberedTooth> teeth);

}  // namespace lefort::dental
