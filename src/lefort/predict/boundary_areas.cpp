#include <lefort/core/check.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/boundary_areas.h>

#include <span>

namespace lefort::predict {

std::vector<BoundaryNode> boundary_nodes(const mesh::VolumeMesh& tissue) {
  std::vector<BoundaryNode> nodes(tissue.nodes_L.size());
  for (const mesh::Face& face : tissue.face_sets.at("boundary")) {
    LEFORT_CHECK(face.shape != mesh::FaceShape::kQuad8);
    double face_mm2 = 0.0;
    for (const mesh::Face3& triangle : mesh::triangles_of(std::span(&face, 1))) {
      const auto corner = [&](std::size_t n) -> const Vec3& {
        return tissue.nodes_L[std::size_t(triangle[n])];
      };
      const Vec3 area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
      face_mm2 += area.norm();
      for (const std::int32_t node : triangle) {
        nodes[std::size_t(node)].area_mm2 += area.norm() / 3.0;
        nodes[std::size_t(node)].normal_L += area;
        if (face.shape != mesh::FaceShape::kTri6)
          nodes[std::size_t(node)].load_area_mm2 += area.norm() / 3.0;
      }
    }
    if (face.shape == mesh::FaceShape::kTri6)
      for (std::size_t n = 3; n < 6; ++n)
        nodes[std::size_t(face.nodes[n])].load_area_mm2 += face_mm2 / 3.0;
  }
  for (BoundaryNode& node : nodes)
    if (const double length = node.normal_L.norm(); length > 0.0) node.normal_L /= length;
  return nodes;
}

}  // namespace lefort::predict
