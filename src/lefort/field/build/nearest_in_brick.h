/// \file
/// Finds the nearest triangle of each point of a brick: the inner loop of building a field.
#pragma once

#include <lefort/field/simd.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <span>

namespace lefort::field {

/// Nearest triangles of the points of a brick, in tiles of 4 x 2 x 2 points. Tiles are compact, so
/// that a triangle that is far from one point of a tile is far from all of them.
struct alignas(64) NearestInBrick {
  static constexpr std::int32_t kNone = -1;
  static constexpr unsigned kTileX = 4, kTileY = 2, kTileZ = 2;
  static constexpr unsigned kTilePoints = kTileX * kTileY * kTileZ;

  /// Bits of a code, from the lowest: the point is below the plane of its nearest triangle; the
  /// closest point is inside the face, not on its boundary; then the number of the triangle.
  static constexpr int kBelowBit = 0, kFaceBit = 1, kTriangleShift = 2;

  std::array<float, SparseLattice::kBrickPoints> squared_mm2;
  std::array<std::int32_t, SparseLattice::kBrickPoints> code;  ///< Or kNone without a triangle.

  [[nodiscard]] static constexpr std::int32_t triangle_of(std::int32_t code) {
    return code >> kTriangleShift;
  }
  [[nodiscard]] static constexpr bool is_face_closest(std::int32_t code) {
    return (code >> kFaceBit & 1) != 0;
  }
  [[nodiscard]] static constexpr bool is_below(std::int32_t code) {
    return (code >> kBelowBit & 1) != 0;
  }

  void clear(float max_distance_mm) {
    squared_mm2.fill(max_distance_mm * max_distance_mm);
    code.fill(kNone);
  }

  /// Position of a point in the arrays: tiles x fastest, points in a tile x fastest.
  [[nodiscard]] static constexpr std::size_t linear_offset(int x, int y, int z) {
    constexpr unsigned kAcross = SparseLattice::kSide / kTileX, kUp = SparseLattice::kSide / kTileY;
    const int tile = (z / kTileZ * kUp + y / kTileY) * kAcross + x / kTileX;
    return std::size_t(tile * kTilePoints + ((z % kTileZ) * kTileY + y % kTileY) * kTileX +
                       x % kTileX);
  }
};

/// Updates the nearest triangle of each point from a list of triangles. At equal distance the
/// triangle visited first is kept. The order of visits depends on the length of the list only.
///
/// Distances are computed in single precision relative to the brick. Their errors are about 1e-7 of
/// the largest of these lengths: max distance, edge of the brick, longest edge of the triangle.
///
/// \param mesh             the surface.
/// \param triangles        of `mesh`, none with three coincident corners.
/// \param low              position of the first point of the brick [mm].
/// \param cell             spacing of its points [mm].
/// \param max_distance_mm  max distance of triangles.
/// \param simd             instruction set; all give the same bits.
/// \param nearest          is updated.
void visit_triangles(const geometry::TriangleMesh& mesh, std::span<const std::int32_t> triangles,
                     const Vec3& low, double cell, double max_distance_mm, Simd simd,
                     NearestInBrick& nearest);

}  // namespace lefort::field
