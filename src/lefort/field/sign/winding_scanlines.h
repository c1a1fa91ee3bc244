/// \file
/// How often a closed surface winds around the points of the lattice: which side is which, however
/// the surface cuts through itself.
#pragma once

#include <lefort/field/field_frame.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <vector>

namespace lefort::field {

/// Where lines along x cross the surface: one to four rows of lattice points, between them.
///
/// The lines run a fraction of a cell beside the points, so that they meet no edge of surfaces
/// that follow the lattice. So the answer is for points further than a cell from the surface only,
/// and those alone need it.
class WindingScanlines {
 public:
  /// \pre the surface is closed: on every edge as many sides run each way.
  WindingScanlines(const geometry::TriangleMesh& mesh_B, const FieldFrame& frame);

  /// True if the surface winds around the point; for lattice points further than a cell from it.
  [[nodiscard]] bool is_inside(const LatticePoint& point) const;

 private:
  struct Crossing {
    float x;               ///< In cells.
    std::int32_t winding;  ///< +1 where the line enters, -1 where it leaves.
  };

  int resolution_;
  std::vector<std::uint32_t> first_;  ///< Of the crossings of each line, y fastest; and their end.
  std::vector<Crossing> crossings_;   ///< By line, then by x.
};

}  // namespace lefort::field
