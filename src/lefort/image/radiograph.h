/// \file
/// Line integrals through a CT: a radiograph without scatter.
#pragma once

#include <lefort/image/volume.h>

#include <optional>
#include <vector>

namespace lefort::image {

/// A picture in the plane through `center_L`. Its scale is exact in that plane.
struct RadiographView {
  Vec3 center_L = Vec3::Zero();  ///< At the center of the picture.
  Vec3 right_L = Vec3::UnitX();  ///< Unit length; rightwards in the picture.
  Vec3 down_L = -Vec3::UnitZ();  ///< Unit length, perpendicular to `right_L`.
  int columns = 1, rows = 1;     ///< >= 1.
  double pixel_mm = 0.5;         ///< Side of a pixel in that plane, > 0.
  /// Distance of the source in front of the plane, from which right_L x down_L points away; none:
  /// parallel rays.
  std::optional<double> source_mm = std::nullopt;
};

/// Integrates the attenuation relative to water, max(0, 1 + HU / 1000), along the ray of each
/// pixel, by the midpoint rule with trilinear interpolation.
///
/// \param ct       voxels outside of the grid are air.
/// \param view     the picture.
/// \param step_mm  of the integration, > 0.
/// \returns the thickness of water that attenuates as much [mm]; rows from the top.
[[nodiscard]] std::vector<double> radiograph(const CtVolume& ct, const RadiographView& view,
                                             double step_mm);

}  // namespace lefort::image
