#include <lefort/field/feature_regions.h>

#include <cmath>

namespace lefort::field {

using geometry::Pseudonormals;
using geometry::TriangleMesh;

FeatureRegions::FeatureRegions(const TriangleMesh& mesh, const Pseudonormals& normals,
                               double reach_mm, double slack_mm)
    : reach_mm_(reach_mm), slack_mm_(slack_mm) {
  regions_.reserve(mesh.triangles.size() + normals.edges.ends.size() + mesh.vertices.size());
  half_spaces_.reserve(8 * mesh.triangles.size() + 4 * normals.edges.ends.size());
  add_faces(mesh, normals);
  add_edges(mesh, normals);
  add_vertices(mesh, normals);
}

void FeatureRegions::begin_region(FeatureKind kind, const Vec3& anchor, const Vec3& axis,
                                  const Vec3& pseudonormal) {
  regions_.push_back(
      {kind, anchor, axis, pseudonormal, Box3(), std::int32_t(half_spaces_.size()), 0});
}

void FeatureRegions::cut(const Vec3& point, const Vec3& outward) {
  const Vec3 n = outward.normalized();
  half_spaces_.push_back({n, n.dot(point) + slack_mm_});
  ++regions_.back().count;
}

void FeatureRegions::add_faces(const TriangleMesh& mesh, const Pseudonormals& normals) {
  const Vec3 slack = Vec3::Constant(slack_mm_);
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3& n = normals.of_face[std::size_t(t)];
    if (n.isZero()) continue;  // Its edges cover it.
    begin_region(FeatureKind::kFace, mesh.corner(t, 0), n, n);
    Box3& box = regions_.back().box;
    for (int k = 0; k < 3; ++k) {
      const Vec3& from = mesh.corner(t, k);
      cut(from, (mesh.corner(t, (k + 1) % 3) - from).cross(n));
      box.extend((from + reach_mm_ * n).eval()).extend((from - reach_mm_ * n).eval());
    }
    cut(mesh.corner(t, 0) + reach_mm_ * n, n);
    cut(mesh.corner(t, 0) - reach_mm_ * n, -n);
    box.min() -= slack;
    box.max() += slack;
  }
}

void FeatureRegions::add_edges(const TriangleMesh& mesh, const Pseudonormals& normals) {
  const Vec3 reach = Vec3::Constant(reach_mm_ + slack_mm_);
  for (Index e = 0; e < normals.edges.edge_count(); ++e) {
    const Vec3& from = mesh.vertices[std::size_t(normals.edges.ends[std::size_t(e)][0])];
    const Vec3& to = mesh.vertices[std::size_t(normals.edges.ends[std::size_t(e)][1])];
    const Vec3 axis = (to - from).normalized();
    begin_region(FeatureKind::kEdge, from, axis, normals.of_edge[std::size_t(e)]);
    regions_.back().box = Box3(from.cwiseMin(to) - reach, from.cwiseMax(to) + reach);
    cut(from, -axis);
    cut(to, axis);
    for (const geometry::EdgeUse& use : normals.edges.uses_of(e)) {
      const Vec3& n = normals.of_face[std::size_t(use.triangle)];
      if (!n.isZero()) cut(from, n.cross(use.forward ? axis : -axis));
    }
  }
}

void FeatureRegions::add_vertices(const TriangleMesh& mesh, const Pseudonormals& normals) {
  std::vector<std::vector<std::int32_t>> neighbours(mesh.vertices.size());
  for (const auto& [a, b] : normals.edges.ends) {
    neighbours[std::size_t(a)].push_back(b);
    neighbours[std::size_t(b)].push_back(a);
  }
  const Vec3 reach = Vec3::Constant(reach_mm_ + slack_mm_);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& at = mesh.vertices[v];
    begin_region(FeatureKind::kVertex, at, Vec3::Zero(), normals.of_vertex[v]);
    regions_.back().box = Box3(at - reach, at + reach);
    for (const std::int32_t other : neighbours[v]) cut(at, mesh.vertices[std::size_t(other)] - at);
  }
}

}  // namespace lefort::field
