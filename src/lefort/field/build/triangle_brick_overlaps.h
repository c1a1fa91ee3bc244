/// \file
/// Which bricks the triangles of a surface reach: the first step of building a field.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/simd.h>
#include <lefort/geometry/triangle_mesh.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace lefort::field {

/// Where bricks of samples lie: brick (0, 0, 0) begins a brick before the origin.
struct BrickGrid {
  Vec3 origin_B;
  double cell_mm;
  int bricks_per_side;
};

/// The bricks of a row of triangles.
struct TriangleBrickOverlaps {
  std::vector<std::int32_t> bricks;  ///< Triangle after triangle, ascending for each.
  std::vector<std::uint32_t> ends;   ///< Of each triangle's bricks.
};

/// Counts bricks in the boxes of triangles, to stop listing them when they are too many.
class OverlapBudget {
 public:
  explicit OverlapBudget(std::int64_t maximum) : max_count_(maximum) {}
  /// \returns false if there are more than `most` now.
  bool add(std::int64_t pairs) { return (count_ += pairs) <= max_count_; }
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] bool too_many() const { return count_ > max_count_; }

 private:
  std::int64_t max_count_;
  std::atomic<std::int64_t> count_ = 0;
};

/// The bricks with a point that may be within `reach_mm` of a triangle, for triangles from `begin`
/// to before `end`. They meet its box, its plane and its sides, all widened by the reach: that
/// leaves no gap at edges and corners, as prisms would.
///
/// \param pairs  is told of all bricks in boxes; once they are too many, triangles have none.
[[nodiscard]] TriangleBrickOverlaps triangle_brick_overlaps(const geometry::TriangleMesh& mesh,
                                                            Index begin, Index end,
                                                            const BrickGrid& grid, double reach_mm,
                                                            OverlapBudget& pairs,
                                                            Simd simd = best_simd());

}  // namespace lefort::field
