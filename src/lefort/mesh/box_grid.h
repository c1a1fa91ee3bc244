/// \file
/// Boxes of regular elements of every shape, and of several joined face to face: for verification,
/// benchmarks and tests.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <random>

namespace lefort::mesh {

/// A box from the origin to `size_mm`, of region 0, by cells that are cut into elements:
///
///     hex8, hex20       one
///     wedge6, wedge15   two, upright, by the plane through the diagonal 0-2
///     pyramid5          six, from the faces to a node in the middle
///     tet4, tet10       six around the diagonal 0-6 (Kuhn)
///
/// Node and face sets: the sides x0, x1, y0, y1, z0, z1 and "boundary", all of them.
///
/// \param cells    along x, y, z, each >= 1; nodes and elements few enough for 32 bits.
/// \param size_mm  > 0.
[[nodiscard]] VolumeMesh make_box(ElementShape shape, std::array<int, 3> cells,
                                  const Vec3& size_mm);

/// Which elements a mixed box is made of.
enum class BoxMix {
  kAllLinear,     ///< Along x: hex8, wedge6, pyramid5 with tet4, tet4; >= 4 cells.
  kHex20Wedge15,  ///< Along x; >= 2 cells.
  kWedge15Tet10,  ///< Along z; >= 2 cells.
};

/// The same of several shapes, every inner face shared by two elements. Each kind fills about the
/// same share of the box.
[[nodiscard]] VolumeMesh make_mixed_box(BoxMix mix, std::array<int, 3> cells, const Vec3& size_mm);

/// Moves each corner of an element that is not on the boundary by up to `reach_mm` along each axis;
/// the middles of edges follow, so that edges stay straight.
///
/// \note The same state of `random` gives the same mesh.
[[nodiscard]] VolumeMesh with_inner_nodes_moved(VolumeMesh mesh, const Vec3& reach_mm,
                                                std::mt19937& random);

}  // namespace lefort::mesh
