/// \file
/// Strain and stress of each element, for looking at.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::fem {

/// Means over the integration points of one element, but for the smallest J. Where the change of
/// volume is averaged, pressure and energy are those of the average.
struct ElementState {
  double min_volume_ratio = 1.0;    ///< J = det F; an element with J <= 0 is inside out.
  Mat3 cauchy_mpa = Mat3::Zero();   ///< True stress, tension positive; NaN where J <= 0.
  Vec3 stretches = Vec3::Ones();    ///< Principal, the largest first; NaN where J <= 0.
  double energy_density_mpa = 0.0;  ///< Per reference volume; NaN where J <= 0.
};

/// \param mesh        accepted by make_element_terms().
/// \param materials   likewise.
/// \param u           displacements of all nodes, 3 per node [mm].
/// \param dilatation  what the terms were made with.
/// \returns one state per element, through the blocks. Beside an element that is inside out those
///   that share an average with it have no stress either.
[[nodiscard]] std::vector<ElementState> element_states(
    const mesh::VolumeMesh& mesh, const RegionMaterials& materials, const VectorX& u,
    VolumetricIntegration volumetric_integration = VolumetricIntegration::kMeanDilatation);

}  // namespace lefort::fem
