/// \file
/// Winding number of a closed surface at lattice points, valid also where the surface intersects
/// itself.
#pragma once

#include <lefort/field/field_frame.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <vector>

namespace lefort::field {

/// Crossings of the surface with lines along x; one line serves up to four rows of lattice points.
///
/// The lines have an offset of a fraction of a cell from the points, so that they do not hit edges
/// of surfaces that follow the lattice. Therefore results are valid only for points further than a
/// cell from the surface. No other point needs a winding number.
class WindingScanlines {
 public:
  /// \param mesh_B  the surface. \pre closed: each edge has equally many triangles in both
  ///   directions.
  /// \param frame   lattice of the field.
  WindingScanlines(const geometry::TriangleMesh& mesh_B, const FieldFrame& frame);

  /// True if the winding number at a lattice point is positive; false outside the cube. \pre the
  /// point is further than a cell from the surface.
  [[nodiscard]] bool is_inside(const LatticePoint& point) const;

 private:
  struct Crossing {
    float x;               ///< In cells.
    std::int32_t winding;  ///< +1 where the line enters, -1 where it leaves.
  };

  int resolution_;
  /// Offset of the crossings of each line, y fastest; one more, the end.
  std::vector<std::uint32_t> first_;
  std::vector<Crossing> crossings_;  ///< By line, then by x.
};

}  // namespace lefort::field
