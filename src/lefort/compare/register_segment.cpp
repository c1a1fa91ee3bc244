#include <lefort/compare/register_segment.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_motion.h>

#include <algorithm>
#include <array>
#include <vector>

namespace lefort::compare {

MovementDifference difference_of(const RigidTransform& first_LB, const RigidTransform& second_LB,
                                 const geometry::TriangleMesh& bone_B) {
  const Vec3 center_B = geometry::bounding_box(bone_B).center();
  MovementDifference difference{
      second_LB * center_B - first_LB * center_B,
      geometry::rotation_vector(second_LB.linear() * first_LB.linear().transpose()), 0.0};
  for (const Vec3& v : bone_B.vertices)
    difference.max_mm = std::max(difference.max_mm, (second_LB * v - first_LB * v).norm());
  return difference;
}

Result<Registration> register_segment(const geometry::TriangleMesh& segment_B,
                                      const geometry::Bvh& after_L,
                                      const RigidTransform& planned_LB, Progress& progress) {
  return register_surface(segment_B, after_L,
                          std::array{planned_LB, RigidTransform(RigidTransform::Identity())}, {},
                          progress);
}

geometry::TriangleMesh unaltered_region(const geometry::TriangleMesh& bone_L,
                                        std::span<const geometry::TriangleMesh> others_L,
                                        double min_distance_mm) {
  std::vector<char> is_near(bone_L.vertices.size(), 0);
  for (const geometry::TriangleMesh& other_L : others_L) {
    const geometry::Bvh tree(other_L);
    parallel_for(bone_L.vertex_count(), [&](Index v) {
      if (tree.closest_point(bone_L.vertices[std::size_t(v)], min_distance_mm))
        is_near[std::size_t(v)] = 1;
    });
  }
  return geometry::keep_triangles(bone_L, [&](Index t) {
    const geometry::Triangle& corners = bone_L.triangles[std::size_t(t)];
    return std::none_of(corners.begin(), corners.end(),
                        [&](std::int32_t v) { return is_near[std::size_t(v)] != 0; });
  });
}

}  // namespace lefort::compare
