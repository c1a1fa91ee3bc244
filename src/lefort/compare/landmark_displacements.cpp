#include <lefort/compare/displacement_at.h>
#include <lefort/compare/landmark_displacements.h>
#include <lefort/geometry/bvh.h>

namespace lefort::compare {
Result<plan::Landmarks> displace_landmarks(std::span<const plan::Landmark> landmarks_L,
                                           const geometry::TriangleMesh& before_L,
                                           const geometry::TriangleMesh& after_L, double near_mm) {
  if (before_L.vertices.size() != after_L.vertices.size() ||
      before_L.triangles != after_L.triangles)
    return fail(ErrorCode::kInvalidArgument,
                "the two skin surfaces do not have the same vertices and triangles, so landmarks "
                "cannot be moved from one to the other");
  std::vector<Vec3> displacement_mm;
  for (std::size_t v = 0; v < before_L.vertices.size(); ++v)
    displacement_mm.push_back(after_L.vertices[v] - before_L.vertices[v]);
  const geometry::Bvh tree(before_L);
  plan::Landmarks carried;
  for (const plan::Landmark& landmark : landmarks_L) {
    const plan::LandmarkKind* const kind = plan::landmark_definition(landmark.name);
    if (kind == nullptr || !kind->is_soft) continue;
    const auto on_skin = tree.closest_point(landmark.point_L, near_mm);
    if (!on_skin) continue;
    carried.push_back(
        {landmark.name, landmark.point_L + displacement_at(before_L, on_skin->triangle,
                                                           on_skin->point, displacement_mm)});
  }
  return carried;
}

}  // namespace lefort::compare
