#include <lefort/contact/dense_faces.h>
#include <lefort/contact/weighted_quadrature.h>

namespace lefort::contact {

std::vector<DenseFace> dense_faces(std::span<const mesh::Face> faces, std::span<const Vec3> x_L) {
  constexpr int kParts = 6;  // Of an edge of a triangle of the division.
  std::vector<DenseFace> all;
  for (const mesh::Face& face : faces) {
    const auto nodes = mesh::nodes_of(face);
    const FaceDivision& division = face_division(face.shape);
    DenseFace& dense = all.emplace_back(DenseFace{&face, 0.0, {}});
    const auto vertex = [&](std::uint8_t v) {
      Vec3 p_L = Vec3::Zero();
      for (std::size_t b = 0; b < nodes.size(); ++b)
        p_L += division.vertices[v].N[b] * x_L[std::size_t(nodes[b])];
      return p_L;
    };
    for (const auto& triangle : division.triangles) {
      const Vec3 a = vertex(triangle[0]), u = vertex(triangle[1]) - a, v = vertex(triangle[2]) - a;
      dense.area_mm2 += 0.5 * u.cross(v).norm();
      for (int i = 0; i <= kParts; ++i)
        for (int j = 0; j <= kParts - i; ++j)
          dense.points_L.push_back(a + (double(i) / kParts) * u + (double(j) / kParts) * v);
    }
  }
  return all;
}

}  // namespace lefort::contact
