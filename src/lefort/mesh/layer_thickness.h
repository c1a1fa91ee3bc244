/// \file
/// How thick a layer of wedges came out, and where it is thin.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::mesh {

/// Faces beside each other that are covered by less than half the wanted thickness, or not at all.
struct ThinPatch {
  double area_mm2 = 0.0;
  Vec3 center_L = Vec3::Zero();  ///< Mean of the faces' centers, areas weighted [mm].
};

/// By area of the outer faces.
struct LayerThickness {
  double area_mm2 = 0.0;  ///< Of all faces looked at.
  double covered_fraction =
      0.0;               ///< Under wedges; the rest lies over pyramids, tetrahedra or nothing.
  double mean_mm = 0.0;  ///< Of what is covered; so are the others.
  double p05_mm = 0.0;   ///< 5 % are thinner.
  double full_thickness_fraction = 0.0;  ///< At least nine tenths of the wanted thickness.
  std::vector<ThinPatch> thin;           ///< The largest first.
};

/// \param region     of the layer's wedges; their outer triangle is their first or their second.
/// \param faces      the outer surface; its quadrilaterals are passed over.
/// \param layers     how many wedges lie one below the other, equally thick.
/// \param wanted_mm  > 0.
[[nodiscard]] LayerThickness layer_thickness_statistics(const VolumeMesh& mesh, std::int32_t region,
                                                        std::span<const Face> faces, int layers,
                                                        double wanted_mm);

}  // namespace lefort::mesh
