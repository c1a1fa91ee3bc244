/// \file
/// A block of soft tissue on which solvers are compared: lower side fixed, upper side moved.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::bench {

/// A cube whose lower side is fixed and whose upper side is moved down and sideways.
struct BlockProblem {
  static constexpr double kSide_mm = 10.0;
  static constexpr double kMu_mpa = 0.1;     ///< Of Psi = mu/2 (J^(-2/3) I1 - 3)
  static constexpr double kKappa_mpa = 0.5;  ///< + kappa/2 (J - 1)^2.

  /// Cells along a side, each a hexahedron or six tetrahedra.
  int cells = 1;
  mesh::ElementShape shape = mesh::ElementShape::kTet10;  ///< Or kHex8.

  /// Node sets of mesh().
  static constexpr const char* kBelow = "z0";
  static constexpr const char* kAbove = "z1";

  [[nodiscard]] mesh::VolumeMesh mesh() const;
  [[nodiscard]] static fem::RegionMaterials materials();

  /// Displacement of the upper side at load fraction t, 0 to 1.
  [[nodiscard]] static Vec3 moved_mm(double t) { return t * kSide_mm * Vec3(0.2, 0.0, -0.2); }
  [[nodiscard]] static std::vector<fem::PrescribedDisplacement> prescribed(
      const mesh::VolumeMesh& mesh, double t);
};

}  // namespace lefort::bench
