/// \file
/// The innermost loop of building a field: which triangle is nearest to each point of a brick.
#pragma once

#include <lefort/field/simd.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <span>

namespace lefort::field {

/// What is known of the points of a brick, in tiles of 4 x 2 x 2 points: compact, so that a
/// triangle that is far from one of its points is far from all.
struct alignas(64) NearestInBrick {
  static constexpr std::int32_t kNone = -1;
  static constexpr unsigned kTileX = 4, kTileY = 2, kTileZ = 2;
  static constexpr unsigned kTilePoints = kTileX * kTileY * kTileZ;

  /// Bits of a code, from the lowest: the point is below the plane of its nearest triangle; the
  /// closest point lies inside the face, not on its boundary; then the number of the triangle.
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

  void clear(float reach_mm) {
    squared_mm2.fill(reach_mm * reach_mm);
    code.fill(kNone);
  }

  /// Where a point is kept: tiles x fastest, points in a tile x fastest.
  [[nodiscard]] static constexpr std::size_t linear_offset(int x, int y, int z) {
    constexpr unsigned kAcross = SparseLattice::kSide / kTileX, kUp = SparseLattice::kSide / kTileY;
    const int tile = (z / kTileZ * kUp + y / kTileY) * kAcross + x / kTileX;
    return std::size_t(tile * kTilePoints + ((z % kTileZ) * kTileY + y % kTileY) * kTileX +
                       x % kTileX);
  }
};

/// Takes each triangle wherever it is strictly nearer than what was known; among equals the first
/// visited stays. The order of visits depends on the length of the list alone.
///
/// The arithmetic of distances is in single precision but relative to the brick, so errors are of
/// the order of 1e-7 of the larger of reach, brick and triangle.
///
/// \param triangles  of `mesh`, none of them a point.
/// \param low        position of the brick's first point; `cell` is the spacing.
/// \param reach_mm   a triangle matters to points this near only.
void visit_triangles(const geometry::TriangleMesh& mesh, std::span<const std::int32_t> triangles,
                     const Vec3& low, double cell, double reach_mm, Simd simd,
                     NearestInBrick& nearest);

}  // namespace lefort::field
