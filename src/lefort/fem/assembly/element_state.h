/// \file
/// Strain and stress of each element, for output.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::fem {

/// Means over the quadrature points of one element, except for the min J. Where the change of
/// volume is averaged, pressure and volumetric energy are computed from the average.
struct ElementState {
  /// Min J = det F; in an inverted element, J of its first point with J <= 0.
  double min_volume_ratio = 1.0;
  Mat3 cauchy_mpa = Mat3::Zero();   ///< Cauchy stress, tension positive; NaN if J <= 0.
  Vec3 stretches = Vec3::Ones();    ///< Principal stretches, descending; NaN if J <= 0.
  double energy_density_mpa = 0.0;  ///< Per reference volume; NaN if J <= 0.
};

/// \param mesh                    accepted by make_element_terms().
/// \param materials               accepted by make_element_terms().
/// \param u                       displacements of all nodes, 3 per node [mm].
/// \param volumetric_integration  as in make_element_terms().
/// \returns one state per element, in the order of the blocks. Stress and energy of an element that
///   shares an average with an inverted element are NaN, too.
[[nodiscard]] std::vector<ElementState> element_states(
    const mesh::VolumeMesh& mesh, const RegionMaterials& materials, const VectorX& u,
    VolumetricIntegration volumetric_integration = VolumetricIntegration::kMeanDilatation);

}  // namespace lefort::fem
