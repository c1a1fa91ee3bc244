#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/boundary_areas.h>

namespace lefort::predict {

std::vector<BoundaryNode> boundary_nodes(const mesh::VolumeMesh& tissue) {
  std::vector<BoundaryNode> nodes(tissue.nodes_L.size());
  for (const mesh::Face3& face : mesh::triangles_of(tissue.face_sets.at("boundary"))) {
    const auto corner = [&](std::size_t n) -> const Vec3& {
      return tissue.nodes_L[std::size_t(face[n])];
    };
    const Vec3 area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (const std::int32_t node : face) {
      nodes[std::size_t(node)].area_mm2 += area.norm() / 3.0;
      nodes[std::size_t(node)].normal_L += area;
    }
  }
  for (BoundaryNode& node : nodes)
    if (const double length = node.normal_L.norm(); length > 0.0) node.normal_L /= length;
  return nodes;
}

}  // namespace lefort::predict
