/// \file
/// The crowns of one jaw as a surface, from a CT and its teeth.
#pragma once

#include <lefort/anatomy/find_teeth.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>

namespace lefort::dental {

/// Crowns of one jaw in frame L.
struct Crowns {
  anatomy::Tooth jaw = anatomy::Tooth::kUpper;
  /// Open, outward: without roots, and without what is not a border of enamel, as contacts of
  /// teeth.
  geometry::TriangleMesh surface_L;
  Vec3 center_L = Vec3::Zero();     ///< Mean of the enamel.
  Vec3 occlusal_L = Vec3::UnitZ();  ///< Unit length: from the roots to the other jaw.
  Vec3 anterior_L = Vec3::UnitY();  ///< Unit length, perpendicular to occlusal_L.
  double border_hu = 0.0;           ///< Half of the median of enamel.
};

/// \returns "upper" or "lower".
[[nodiscard]] constexpr const char* name_of(anatomy::Tooth jaw) {
  return jaw == anatomy::Tooth::kLower ? "lower" : "upper";
}

/// Finds the crowns of a jaw.
///
/// The surface first lies where the CT number is half of that of enamel: the border of a dense body
/// in blurred images does not move there (\cite prevrhal1999), if its surroundings have 0 HU. Then
/// each vertex moves along its normal, by up to 0.5 mm, to where the CT number is half way between
/// the largest one inside (at most 1.25 times enamel: not metal) and the smallest one outside,
/// within 1.5 mm (half-maximum height, \cite spoor1993). Vertices without such a place stay. The
/// occlusal plane is the least-squares
/// plane through the enamel; crowns are what lies less than 6 mm on the side of the roots.
///
/// \param ct     the scan; teeth of the wanted jaw must be on it.
/// \param teeth  of the scan. \pre on the grid of `ct`.
/// \param jaw    kUpper or kLower.
/// \returns the crowns, or
///   - kAnatomyMissing  too little enamel; teeth on less than 25 mm of the arch or in a row, which
///     do not determine a plane; or no border of enamel;
///   - kMeshInvalid, kCancelled  as anatomy::extract_isosurface().
[[nodiscard]] Result<Crowns> find_crowns(const image::CtVolume& ct, const anatomy::ToothMap& teeth,
                                         anatomy::Tooth jaw, Progress& progress = Progress::none());

}  // namespace lefort::dental
