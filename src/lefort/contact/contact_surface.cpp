#include <lefort/contact/contact_surface.h>
#include <lefort/core/check.h>
#include <lefort/mesh/element_faces.h>

#include <algorithm>

namespace lefort::contact {

std::vector<Vec3> displaced(std::span<const Vec3> nodes_L, const VectorX& u) {
  LEFORT_CHECK(u.size() == 3 * Index(nodes_L.size()));
  std::vector<Vec3> x_L(nodes_L.begin(), nodes_L.end());
  for (std::size_t n = 0; n < x_L.size(); ++n) x_L[n] += u.segment<3>(3 * Index(n));
  return x_L;
}

ContactSurface::ContactSurface(std::span<const Vec3> nodes_L, std::span<const mesh::Face> faces) {
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

}  // namespace lefort::contact
