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
      DensePoint at{.x_L = Vec3::Zero(), .hat = division.vertices[v].hat};
      for (std::size_t b = 0; b < nodes.size(); ++b)
        at.x_L += division.vertices[v].N[b] * x_L[std::size_t(nodes[b])];
      return at;
    };
    for (const auto& triangle : division.triangles) {
      const DensePoint a = vertex(triangle[0]), b = vertex(triangle[1]), c = vertex(triangle[2]);
      dense.area_mm2 += 0.5 * (b.x_L - a.x_L).cross(c.x_L - a.x_L).norm();
      for (int i = 0; i <= kParts; ++i)
        for (int j = 0; j <= kParts - i; ++j) {
          const double u = double(i) / kParts, v = double(j) / kParts;
          DensePoint& point = dense.points.emplace_back();
          point.x_L = a.x_L + u * (b.x_L - a.x_L) + v * (c.x_L - a.x_L);
          for (std::size_t n = 0; n < nodes.size(); ++n)
            point.hat[n] = (1.0 - u - v) * a.hat[n] + u * b.hat[n] + v * c.hat[n];
        }
    }
  }
  return all;
}

}  // namespace lefort::contact
