#include <lefort/compare/landmark_displacements.h>
#include <lefort/geometry/bvh.h>

#include <Eigen/LU>

namespace lefort::compare {
namespace {

/// Barycentric coordinates of a point of a triangle; by least squares for a degenerate triangle.
Vec3 barycentric(const geometry::TriangleMesh& mesh, Index triangle, const Vec3& p) {
  const Vec3 a = mesh.corner(triangle, 0);
  Eigen::Matrix<double, 3, 2> edges;
  edges << mesh.corner(triangle, 1) - a, mesh.corner(triangle, 2) - a;
  const Eigen::Vector2d along =
      (edges.transpose() * edges).fullPivLu().solve(edges.transpose() * (p - a));
  return {1.0 - along.sum(), along[0], along[1]};
}

}  // namespace

Result<plan::Landmarks> carry_landmarks(std::span<const plan::Landmark> landmarks_L,
                                        const geometry::TriangleMesh& before_L,
                                        const geometry::TriangleMesh& after_L, double near_mm) {
  if (before_L.vertices.size() != after_L.vertices.size() ||
      before_L.triangles != after_L.triangles)
    return fail(ErrorCode::kInvalidArgument,
                "the two skin surfaces do not have the same vertices and triangles, so landmarks "
                "cannot be moved from one to the other");
  const geometry::Bvh tree(before_L);
  plan::Landmarks carried;
  for (const plan::Landmark& landmark : landmarks_L) {
    const plan::LandmarkKind* const kind = plan::landmark_definition(landmark.name);
    if (kind == nullptr || !kind->is_soft) continue;
    const auto on_skin = tree.closest_point(landmark.point_L, near_mm);
    if (!on_skin) continue;
    const Vec3 weights = barycentric(before_L, on_skin->triangle, on_skin->point);
    Vec3 displacement_mm = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      displacement_mm += weights[k] * (after_L.corner(on_skin->triangle, k) -
                                       before_L.corner(on_skin->triangle, k));
    carried.push_back({landmark.name, landmark.point_L + displacement_mm});
  }
  return carried;
}

}  // namespace lefort::compare
