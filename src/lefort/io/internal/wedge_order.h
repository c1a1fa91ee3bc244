/// \file
/// The two node numberings of a wedge.
///
/// In VTK's documentation nodes 0, 1, 2 are counter-clockwise as seen from outside; in Gmsh, Abaqus
/// and others, and in VTK's own parametric coordinates, they are counter-clockwise as seen from
/// inside. VTK files therefore occur with both numberings.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lefort::io::internal {

/// Index of each node of a wedge6 (the first six) or wedge15 in the other numbering.
inline constexpr std::array<std::uint8_t, 15> kOtherWedgeOrder{0, 2,  1,  3, 5,  4,  8, 7,
                                                               6, 11, 10, 9, 12, 14, 13};

/// Renumbers every wedge of a block whose nodes 0, 1, 2 are counter-clockwise as seen from inside.
/// The volume of a wedge is positive with one numbering only.
inline void renumber_wedges(mesh::ElementBlock& block, std::span<const Vec3> nodes_L) {
  const auto count = std::size_t(mesh::node_count(block.shape));
  for (std::size_t first = 0; first < block.nodes.size(); first += count) {
    const auto x = [&](std::size_t a) -> const Vec3& {
      return nodes_L[std::size_t(block.nodes[first + a])];
    };
    const Vec3 across = x(3) + x(4) + x(5) - x(0) - x(1) - x(2);
    if (!((x(1) - x(0)).cross(x(2) - x(0)).dot(across) > 0.0)) continue;
    std::array<std::int32_t, 15> turned{};
    for (std::size_t a = 0; a < count; ++a) turned[a] = block.nodes[first + kOtherWedgeOrder[a]];
    for (std::size_t a = 0; a < count; ++a) block.nodes[first + a] = turned[a];
  }
}

}  // namespace lefort::io::internal
