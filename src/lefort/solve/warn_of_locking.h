/// \file
/// Warnings of element shapes that are unsuitable for nearly incompressible laws.
#pragma once

#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>

#include <string>
#include <vector>

namespace lefort::solve {

/// A law with at least this Poisson's ratio counts as nearly incompressible: its bulk modulus is
/// ten times its shear modulus.
inline constexpr double kNearlyIncompressiblePoisson = 0.45;

/// \param mesh       with regions.
/// \param materials  of every region.
/// \returns at most two warnings: of linear elements that lock, and of hex8 whose pressure is not
///   stable (fem/locking/volumetric_integration.h).
[[nodiscard]] std::vector<std::string> warn_of_locking(const mesh::VolumeMesh& mesh,
                                                       const fem::RegionMaterials& materials);

}  // namespace lefort::solve
