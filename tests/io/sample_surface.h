/// \file
/// A minimal closed surface.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::test {

/// A tetrahedron without symmetry, which detects swapped axes; coordinates are exact in float.
inline geometry::TriangleMesh tetrahedron() {
  return {{{1.0, 0.5, 0.25}, {4.0, 1.0, 0.0}, {0.0, 7.0, 2.0}, {1.5, 2.0, 9.0}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

}  // namespace lefort::test
