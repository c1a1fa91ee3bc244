/// \file
/// Finds the bricks near each triangle: the first step of building a field.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/simd.h>
#include <lefort/geometry/triangle_mesh.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace lefort::field {

/// Positions of the bricks of a lattice; brick (0, 0, 0) begins one brick before the origin.
struct BrickGrid {
  Vec3 origin_B;
  double cell_mm;
  int bricks_per_side;
};

/// The bricks of a range of triangles.
struct TriangleBrickOverlaps {
  std::vector<std::int32_t> bricks;  ///< By triangle, ascending for each.
  std::vector<std::uint32_t> ends;   ///< End of the bricks of each triangle.
};

/// Limits the number of pairs of a triangle and a brick in its box.
class OverlapBudget {
 public:
  explicit OverlapBudget(std::int64_t maximum) : max_count_(maximum) {}
  /// \returns false if the count now exceeds the maximum.
  bool add(std::int64_t pairs) { return (count_ += pairs) <= max_count_; }
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] bool too_many() const { return count_ > max_count_; }

 private:
  std::int64_t max_count_;
  std::atomic<std::int64_t> count_ = 0;
};

/// Finds the bricks with a point that may be within `max_distance_mm` of a triangle. These bricks
/// intersect the bounding box of the triangle and each of five half-spaces (two of its plane, three
/// of its edges), all extended by that distance. The paper extrudes triangles along their normals,
/// which leaves gaps at convex edges and corners; this region leaves none.
///
/// \param mesh             the surface.
/// \param begin            first triangle.
/// \param end              one after the last triangle.
/// \param grid             positions of the bricks.
/// \param max_distance_mm  max distance.
/// \param pairs            counts all bricks in boxes. Above its maximum, triangles get no bricks.
/// \param simd             instruction set; all give the same bits.
[[nodiscard]] TriangleBrickOverlaps triangle_brick_overlaps(
    const geometry::TriangleMesh& mesh, Index begin, Index end, const BrickGrid& grid,
    double max_distance_mm, OverlapBudget& pairs, Simd simd = best_simd());

}  // namespace lefort::field
