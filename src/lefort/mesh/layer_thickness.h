/// \file
/// Thickness of a boundary layer, and where it is thin.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::mesh {

/// Adjacent faces that are covered by less than half of the required thickness, or not at all.
struct ThinPatch {
  double area_mm2 = 0.0;
  Vec3 center_L = Vec3::Zero();  ///< Area-weighted mean of the face centers [mm].
};

/// Statistics weighted by the area of the outer faces.
struct LayerThickness {
  double area_mm2 = 0.0;  ///< Of all triangular faces.
  /// Fraction of the area over wedges; the rest lies over pyramids, tetrahedra or no layer.
  double covered_fraction = 0.0;
  double mean_mm = 0.0;  ///< Over the covered area.
  double p05_mm = 0.0;   ///< 5th percentile over the covered area.
  /// Fraction of the covered area with at least 0.9 of the required thickness.
  double full_thickness_fraction = 0.0;
  std::vector<ThinPatch> thin;  ///< The largest first.
};

/// \param mesh       with a boundary layer (mesh/boundary_layer.h).
/// \param region     region of the wedges; either triangle of a wedge may be the outer one.
/// \param faces      the outer surface; quadrilaterals are ignored.
/// \param layers     number of layers, of equal thickness.
/// \param wanted_mm  required thickness, > 0.
/// \returns the statistics.
[[nodiscard]] LayerThickness layer_thickness_statistics(const VolumeMesh& mesh, std::int32_t region,
                                                        std::span<const Face> faces, int layers,
                                                        double wanted_mm);

}  // namespace lefort::mesh
