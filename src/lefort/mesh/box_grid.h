/// \file
/// Boxes of regular elements of one shape, or of several shapes joined face to face: for
/// verification, benchmarks and tests.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <random>

namespace lefort::mesh {

/// Makes a box from the origin to `size_mm`, of region 0. Each cell is divided into elements:
///
///     hex8, hex20       one
///     wedge6, wedge15   two with axes along z, divided by the plane through corners 0, 2, 6 and 4
///     pyramid5          six, from the faces to a node at the center
///     tet4, tet10       six around the diagonal 0-6 (Kuhn)
///
/// Node and face sets: the sides x0, x1, y0, y1, z0, z1, and "boundary" for all of them.
///
/// \param shape    of all elements.
/// \param cells    number of cells along x, y, z, each >= 1; at most 2^31 / 12 grid nodes.
/// \param size_mm  edge lengths, > 0.
/// \returns the mesh, one block.
[[nodiscard]] VolumeMesh make_box(ElementShape shape, std::array<int, 3> cells,
                                  const Vec3& size_mm);

/// Which elements a mixed box is made of.
enum class BoxMix {
  kAllLinear,     ///< Along x: hex8, wedge6, pyramid5 with tet4, tet4; >= 4 cells.
  kHex20Wedge15,  ///< Along x; >= 2 cells.
  kWedge15Tet10,  ///< Along z; >= 2 cells.
};

/// Makes a box as make_box(), but of several element shapes; every interior face belongs to two
/// elements. Each shape fills about the same fraction of the box.
///
/// \param mix      which shapes, and along which axis they follow each other.
/// \param cells    as for make_box(), at least as many as BoxMix states.
/// \param size_mm  edge lengths, > 0.
/// \returns the mesh, one block per shape.
[[nodiscard]] VolumeMesh make_mixed_box(BoxMix mix, std::array<int, 3> cells, const Vec3& size_mm);

/// Moves each interior corner node randomly, by up to `max_displacement_mm` along each axis;
/// mid-edge nodes move with their edges, so that edges stay straight.
///
/// \param mesh                 elements of any shape.
/// \param max_displacement_mm  largest displacement along each axis.
/// \param random               the same state gives the same mesh.
/// \returns the mesh with moved nodes.
[[nodiscard]] VolumeMesh with_inner_nodes_moved(VolumeMesh mesh, const Vec3& max_displacement_mm,
                                                std::mt19937& random);

}  // namespace lefort::mesh
