/// \file
/// What a field was made of, and what had to be mended first.
#pragma once

#include <lefort/core/types.h>

namespace lefort::field {

/// What was found in a surface and, as far as that is unambiguous, mended.
struct MeshRepairReport {
  Index repeated_vertices = 0;    ///< At the position of another, or in no triangle; dropped.
  Index collapsed_triangles = 0;  ///< Two corners at one place; dropped.
  Index repeated_triangles = 0;   ///< Same corners, same sense; dropped.
  Index opposite_duplicates = 0;  ///< Same corners, opposite sense: no inside between them.
  Index flipped_triangles = 0;    ///< Turned to agree with their neighbors, or with being closed.
  Index boundary_edges = 0;       ///< With one triangle.
  Index non_manifold_edges = 0;   ///< With three or more.
  Index inconsistent_edges = 0;   ///< Two triangles that disagree and cannot be turned (Moebius).

  bool operator==(const MeshRepairReport&) const = default;
};

/// The surface behind a field, in numbers.
struct FieldSource {
  Index triangles = 0;  ///< After mending.
  Index parts = 0;      ///< That hang together by edges.
  MeshRepairReport report{};

  bool operator==(const FieldSource&) const = default;
};

}  // namespace lefort::field
