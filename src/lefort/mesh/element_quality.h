/// \file
/// How well shaped the tetrahedra of a mesh are.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <vector>

namespace lefort::mesh {

/// Measures of one tetrahedron; all lengths cancel but in the volume.
struct TetQuality {
  double volume_mm3;        ///< Negative if inverted.
  double min_dihedral_deg;  ///< Regular: arccos(1/3) = 70.53.
  double max_dihedral_deg;
  double scaled_jacobian;  ///< Smallest over the corners, 1 if regular, <= 0 if inverted.
  double radius_ratio;     ///< 3 inradius / circumradius, 1 if regular, 0 if flat.
};

/// The measures of the tetrahedron a, b, c, d; positive volume if d lies on the side of abc from
/// which abc is counter-clockwise.
[[nodiscard]] TetQuality tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The measures of a whole mesh.
struct MeshQuality {
  Index elements = 0;
  double volume_mm3 = 0.0;
  double smallest_volume_mm3 = 0.0;
  double min_dihedral_deg = 0.0;
  double max_dihedral_deg = 0.0;
  double min_scaled_jacobian = 0.0;
  double mean_scaled_jacobian = 0.0;
  double min_radius_ratio = 0.0;
  double mean_radius_ratio = 0.0;
  /// Elements by smallest dihedral angle, ten degrees per bin, 0 to 80.
  std::array<Index, 8> dihedral_histogram{};
  std::vector<Index> inverted;  ///< Elements without positive volume, counted through the blocks.
};

/// \pre Every block is kTet4.
[[nodiscard]] MeshQuality measure_quality(const VolumeMesh& mesh);

}  // namespace lefort::mesh
