#include <lefort/contact/contact_surface.h>
#include <lefort/mesh/element_faces.h>

#include <algorithm>
#include <map>

namespace lefort::contact {

ContactSurface::ContactSurface(std::span<const Vec3> nodes_L, std::span<const mesh::Face> faces,
                               Integration integration) {
  if (integration == Integration::kQuadrature)
    add_faces(nodes_L, faces);
  else
    add_nodes(nodes_L, faces);
}

void ContactSurface::add_faces(std::span<const Vec3> nodes_L, std::span<const mesh::Face> faces) {
  patches_.reserve(faces.size());
  for (const mesh::Face& face : faces) {
    const auto nodes = mesh::nodes_of(face);
    ContactPatch patch{.count = std::uint8_t(nodes.size()),
                       .rule = std::uint8_t(face.shape),
                       .first_point = areas_mm2_.size()};
    std::copy(nodes.begin(), nodes.end(), patch.nodes.begin());
    const PatchPositions x(nodes, nodes_L);
    for (const QuadraturePoint& point : face_quadrature(patch.rule).points)
      areas_mm2_.push_back(contact::area_mm2(point, x.span()));
    patches_.push_back(patch);
  }
}

void ContactSurface::add_nodes(std::span<const Vec3> nodes_L, std::span<const mesh::Face> faces) {
  std::map<std::int32_t, double> lumped_mm2;
  for (const mesh::Face& face : faces) {
    const auto nodes = mesh::nodes_of(face);
    const PatchPositions x(nodes, nodes_L);
    double face_mm2 = 0.0;
    for (const QuadraturePoint& point : face_quadrature(std::size_t(face.shape)).points)
      face_mm2 += contact::area_mm2(point, x.span());
    for (std::size_t a = 0; a < nodes.size(); ++a)
      lumped_mm2[nodes[a]] += face_mm2 * lumped_weight(face.shape, a);
  }
  for (const auto& [node, area_mm2] : lumped_mm2) {
    patches_.push_back(
        {.nodes = {node}, .count = 1, .rule = kNodeRule, .first_point = areas_mm2_.size()});
    areas_mm2_.push_back(area_mm2);
  }
}

}  // namespace lefort::contact
