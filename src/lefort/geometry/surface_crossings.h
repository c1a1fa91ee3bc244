/// \file
/// Where lines parallel to an axis cross a surface: an orthographic view with all its layers.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lefort::geometry {

/// The crossings of a regular grid of parallel lines with a surface.
///
/// The lines are parallel to one coordinate axis; columns and rows follow the other two in cyclic
/// order: for axis y the column number increases with z, the row number with x. For a closed
/// surface within the window the crossings of a line alternate between entry and exit.
class SurfaceCrossings {
 public:
  /// \param mesh      the surface.
  /// \param axis      0 to 2: x, y or z.
  /// \param window    crossings outside this box are omitted.
  /// \param pixel_mm  distance between adjacent lines, > 0.
  SurfaceCrossings(const TriangleMesh& mesh, int axis, const Box3& window, double pixel_mm);

  /// The coordinates of all crossings of the line closest to `p`, in ascending order. The position
  /// of `p` along the axis is ignored. Empty if `p`, along the axis, lies beside the window.
  [[nodiscard]] std::span<const double> crossings(const Vec3& p) const;
  /// The crossing with the smallest coordinate on the line closest to `p`.
  [[nodiscard]] std::optional<Vec3> first(const Vec3& p) const;
  /// The crossing with the largest coordinate on the line closest to `p`.
  [[nodiscard]] std::optional<Vec3> last(const Vec3& p) const;

  /// The first, or the last, crossing of each line, where it lies in `box`; row by row.
  [[nodiscard]] std::vector<Vec3> first_within(const Box3& box) const;
  [[nodiscard]] std::vector<Vec3> last_within(const Box3& box) const;

  [[nodiscard]] double pixel_mm() const { return pixel_mm_; }

 private:
  [[nodiscard]] std::optional<Index> line_at(const Vec3& p) const;
  [[nodiscard]] Vec3 point_of(Index line, double coordinate) const;
  [[nodiscard]] std::vector<Vec3> within(const Box3& box, bool is_first) const;
  template <class OnCrossing>
  void visit_triangle(const TriangleMesh& mesh, Index triangle,
                      const OnCrossing& on_crossing) const;

  int axis_, across_, along_;
  Box3 window_;
  double pixel_mm_;
  Index columns_, rows_;
  std::vector<Index> begin_;  ///< Of each line in crossings_; one more at the end.
  std::vector<double> crossings_;
};

}  // namespace lefort::geometry
