/// \file
/// Orbits and piriform aperture: the cavities of the skull as seen from the front.
#pragma once

#include <lefort/geometry/surface_crossings.h>

#include <array>
#include <optional>

namespace lefort::plan::internal {

/// Heights and widths in F (LandmarkSearch::X_FL).
struct FacialCavities {
  double orbit_low_mm, orbit_high_mm;       ///< z of the lowest and highest row of the orbits.
  std::array<double, 2> orbit_center_x_mm;  ///< Right and left.
  std::optional<double> aperture_low_mm;    ///< z of the floor of the piriform aperture.

  [[nodiscard]] double orbit_center_mm() const { return 0.5 * (orbit_low_mm + orbit_high_mm); }
};

/// A point belongs to a cavity if bone on both sides of it, in its row, lies at least 6 mm (orbits)
/// or 4 mm (aperture) anterior to it: gray-scale hole filling row by row \cite soille2003. The
/// orbits are the sequence of rows with the most such points on both sides of the mid-sagittal
/// plane, the aperture that with the most such points in the middle below the centers of the
/// orbits.
///
/// \param front  skull in F, columns along y.
/// \returns nothing if there are no orbits of at least 15 mm height.
[[nodiscard]] std::optional<FacialCavities> find_facial_cavities(
    const geometry::SurfaceCrossings& front);

}  // namespace lefort::plan::internal
