/// \file
/// Points on sharp parts of a bone: edges and tips that pass between the nodes of the tissue.
///
/// A part is sharp if the tissue mesh cannot follow it: its radius of curvature is less than the
/// element size h. Let t be a unit tangent at a surface point p, and r = h / 2. If the surface has
/// the curvature 1/h along t, its signed distance g at p +- r t is r^2 / (2 h) = h / 8. Therefore p
/// is sharp if
///
///   max over t of min(g(p + r t), g(p - r t)) > h / 8
///
/// A fold of the triangles that is much smaller than h does not make a part sharp.
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::contact {

/// A point on the surface of a bone, in B or L.
struct BonePoint {
  Vec3 p;
  Vec3 normal;  ///< Outward, unit length; at edges and vertices the mean of the faces.
};

/// Points on the surface of a bone, with their search structure. Immutable.
class BonePoints {
 public:
  BonePoints() = default;

  /// \param points      on the surface.
  /// \param spacing_mm  typical distance of the points, > 0: min cell size of the search structure.
  BonePoints(std::vector<BonePoint> points, double spacing_mm);

  [[nodiscard]] std::size_t size() const { return points_B_.size(); }
  [[nodiscard]] std::span<const Vec3> points_B() const { return points_B_; }
  [[nodiscard]] std::span<const Vec3> normals_B() const { return normals_B_; }
  [[nodiscard]] double spacing_mm() const { return spacing_mm_; }

  /// Calls f(number) for every point in a box, in an order that depends on the points only.
  template <class Function>
  void for_each_in(const Box3& box_B, const Function& f) const {
    if (points_B_.empty() || !box_B_.intersects(box_B)) return;
    const Eigen::Array3i low = cell_of(box_B.min()), high = cell_of(box_B.max());
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y)
        for (std::size_t n = first_[number_of(low.x(), y, z)];
             n < first_[number_of(high.x(), y, z) + 1]; ++n)
          if (box_B.contains(points_B_[n])) f(n);
  }

 private:
  [[nodiscard]] Eigen::Array3i cell_of(const Vec3& p_B) const;
  [[nodiscard]] std::size_t number_of(int x, int y, int z) const {
    return std::size_t(x) +
           std::size_t(cells_.x()) * (std::size_t(y) + std::size_t(cells_.y()) * std::size_t(z));
  }

  std::vector<Vec3> points_B_, normals_B_;  ///< By cell.
  double spacing_mm_ = 1.0;
  Box3 box_B_;
  double cell_mm_ = 1.0;
  Eigen::Array3i cells_ = Eigen::Array3i::Ones();
  std::vector<std::size_t> first_;  ///< Of each cell, and the end.
};

/// \param bone_B  triangles counter-clockwise seen from outside.
/// \returns its vertices with normals, without vertices that only degenerate triangles have.
[[nodiscard]] std::vector<BonePoint> vertices_of(const geometry::TriangleMesh& bone_B);

/// \param bone_B            triangles counter-clockwise seen from outside.
/// \param distance_query_B  of the bone; its range is at least element_size_mm / 8.
/// \param element_size_mm   h > 0, of the tissue.
/// \returns those vertices of the bone, and points along its edges at most h / 10 apart, that are
///   sharp.
[[nodiscard]] BonePoints sharp_points(const geometry::TriangleMesh& bone_B,
                                      const DistanceQuery& distance_query_B,
                                      double element_size_mm);

}  // namespace lefort::contact
