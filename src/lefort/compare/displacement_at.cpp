#include <lefort/compare/displacement_at.h>
#include <lefort/core/decompositions.h>

namespace lefort::compare {

Vec3 displacement_at(const geometry::TriangleMesh& surface_L, Index triangle, const Vec3& p_L,
                     std::span<const Vec3> displacement_mm) {
  const Vec3 a_L = surface_L.corner(triangle, 0);
  Eigen::Matrix<double, 3, 2> edges;
  edges << surface_L.corner(triangle, 1) - a_L, surface_L.corner(triangle, 2) - a_L;
  const Eigen::Vector2d along =
      solve_by_full_lu(edges.transpose() * edges, edges.transpose() * (p_L - a_L));
  const Vec3 weights(1.0 - along.sum(), along[0], along[1]);
  Vec3 sum_mm = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto vertex = std::size_t(surface_L.triangles[std::size_t(triangle)][k]);
    sum_mm += weights[Index(k)] * displacement_mm[vertex];
  }
  return sum_mm;
}

}  // namespace lefort::compare
