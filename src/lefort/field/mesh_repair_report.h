/// \file
/// The surface a field was built from, and its repairs.
#pragma once

#include <lefort/core/types.h>

namespace lefort::field {

/// Defects of a surface. Those that can be repaired unambiguously were repaired.
struct MeshRepairReport {
  Index duplicate_vertices = 0;  ///< At the position of another vertex, or in no triangle; dropped.
  Index degenerate_triangles = 0;  ///< Two corners coincide; dropped.
  Index duplicate_triangles = 0;   ///< Same corners and orientation as another one; dropped.
  Index opposite_duplicates = 0;   ///< Same corners, opposite orientation: they enclose no volume.
  Index flipped_triangles = 0;     ///< Flipped to agree with neighbors, or to face outward.
  Index boundary_edges = 0;        ///< With one triangle.
  Index non_manifold_edges = 0;    ///< With three or more triangles.
  /// Of two triangles that flipping cannot make consistent (Moebius strip).
  Index inconsistent_edges = 0;

  bool operator==(const MeshRepairReport&) const = default;
};

/// Properties of the surface a field was built from.
struct FieldSource {
  Index triangles = 0;   ///< After repair.
  Index components = 0;  ///< Connected components (linked by edges).
  MeshRepairReport report{};

  bool operator==(const FieldSource&) const = default;
};

}  // namespace lefort::field
