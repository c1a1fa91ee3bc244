#include <lefort/geometry/pseudonormals.h>

#include <cmath>

namespace lefort::geometry {

namespace {

/// How many triangles without area in a row are walked through to find a normal.
constexpr int kMaxSteps = 32;

double side_length(const TriangleMesh& mesh, Index triangle, int side) {
  return (mesh.corner(triangle, (side + 1) % 3) - mesh.corner(triangle, side)).norm();
}

/// The normal of a triangle without area, seen from its `side`: that of the triangle beyond. A cap
/// (three corners in a row) extends the neighbour at its long side, or seen from there those at the
/// short ones; a needle extends its neighbour across.
Vec3 normal_beyond(const TriangleMesh& mesh, const Pseudonormals& normals, Index triangle,
                   int side) {
  for (int step = 0; step < kMaxSteps; ++step) {
    const int next = (side + 1) % 3, previous = (side + 2) % 3;
    side = side_length(mesh, triangle, next) >= side_length(mesh, triangle, previous) ? next
                                                                                      : previous;
    const Index edge = normals.edges.of_triangle[std::size_t(triangle)][std::size_t(side)];
    const EdgeUse* beyond = nullptr;
    for (const EdgeUse& use : normals.edges.uses_of(edge)) {
      if (use.triangle == triangle) continue;
      if (!normals.of_face[std::size_t(use.triangle)].isZero())
        return normals.of_face[std::size_t(use.triangle)];
      if (beyond == nullptr) beyond = &use;
    }
    if (beyond == nullptr) break;
    triangle = beyond->triangle;
    side = beyond->side;
  }
  return Vec3::Zero();
}

/// The same seen from a corner: the triangle across the opposite side.
Vec3 normal_opposite(const TriangleMesh& mesh, const Pseudonormals& normals, Index triangle,
                     int corner) {
  const int side = (corner + 1) % 3;
  const Index edge = normals.edges.of_triangle[std::size_t(triangle)][std::size_t(side)];
  for (const EdgeUse& use : normals.edges.uses_of(edge)) {
    if (use.triangle == triangle) continue;
    const Vec3& n = normals.of_face[std::size_t(use.triangle)];
    return n.isZero() ? normal_beyond(mesh, normals, use.triangle, use.side) : n;
  }
  return Vec3::Zero();
}

double corner_angle(const TriangleMesh& mesh, Index triangle, int corner) {
  const Vec3& at = mesh.corner(triangle, corner);
  const Vec3 u = mesh.corner(triangle, (corner + 1) % 3) - at;
  const Vec3 v = mesh.corner(triangle, (corner + 2) % 3) - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

std::vector<Vec3> face_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.triangles.size(), Vec3::Zero());
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    if (!triangle_is_degenerate(a, b, c))
      normals[std::size_t(t)] = (b - a).cross(c - a).normalized();
  }
  return normals;
}

}  // namespace

Pseudonormals compute_pseudonormals(const TriangleMesh& mesh) {
  Pseudonormals normals;
  normals.edges = find_edges(mesh);
  normals.of_face = face_normals(mesh);
  normals.of_edge.assign(std::size_t(normals.edges.edge_count()), Vec3::Zero());
  normals.of_vertex.assign(mesh.vertices.size(), Vec3::Zero());

  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3& n = normals.of_face[std::size_t(t)];
    const bool degenerate = n.isZero();
    for (int k = 0; k < 3; ++k) {
      const auto side = std::size_t(k);
      const Index edge = normals.edges.of_triangle[std::size_t(t)][side];
      const auto vertex = std::size_t(mesh.triangles[std::size_t(t)][side]);
      const Vec3 at_edge = degenerate ? normal_beyond(mesh, normals, t, k) : n;
      const Vec3 at_vertex = degenerate ? normal_opposite(mesh, normals, t, k) : n;
      normals.of_edge[std::size_t(edge)] += at_edge;
      normals.of_vertex[vertex] += corner_angle(mesh, t, k) * at_vertex;
    }
  }
  for (Vec3& n : normals.of_vertex) n.stableNormalize();  // Leaves zero as it is.
  return normals;
}

const Vec3& Pseudonormals::at(const TriangleMesh& mesh, Index triangle, Feature feature) const {
  const auto number = std::size_t(number_of(feature));
  if (is_vertex(feature))
    return of_vertex[std::size_t(mesh.triangles[std::size_t(triangle)][number])];
  if (is_edge(feature))
    return of_edge[std::size_t(edges.of_triangle[std::size_t(triangle)][number])];
  return of_face[std::size_t(triangle)];
}

}  // namespace lefort::geometry
