#include <lefort/mesh/boundary_layer.h>
#include <lefort/mesh/internal/layer_constraints.h>

#include <algorithm>
#include <cmath>

namespace lefort::mesh::internal {
namespace {

// Sine of the angle between a vector and the span of the others, below which it counts as dependent
// (6 degrees). Heuristic.
constexpr double kMinIndependentSine = 0.1;

/// \returns an orthonormal basis of the span of unit vectors; nearly dependent ones are left out.
std::vector<Vec3> orthonormal_basis(const std::vector<Vec3>& vectors) {
  std::vector<Vec3> basis;
  for (Vec3 v : vectors) {
    for (const Vec3& b : basis) v -= b.dot(v) * b;
    if (v.norm() > kMinIndependentSine) basis.push_back(v.normalized());
  }
  return basis;
}

Face3 sorted_corners(Face3 face) {
  std::sort(face.begin(), face.end());
  return face;
}

}  // namespace

bool lies_on(const Vec3& p_L, const HalfSpace& plane) {
  return std::abs(plane.normal.normalized().dot(p_L - plane.point)) <= kOnPlane_mm;
}

LayerConstraints::LayerConstraints(const LayerSurface& surface, std::span<const Face3> boundary,
                                   std::span<const HalfSpace> cut_planes)
    : blocked_(surface.nodes_L.size()), is_layer_boundary_(surface.nodes_L.size(), 0) {
  std::vector<Face3> covered = surface.faces;
  std::transform(covered.begin(), covered.end(), covered.begin(), sorted_corners);
  std::sort(covered.begin(), covered.end());
  for (const Face3& face : boundary) {
    if (std::binary_search(covered.begin(), covered.end(), sorted_corners(face))) continue;
    bool is_cut = false;
    for (const HalfSpace& plane : cut_planes) {
      if (!is_cut_face(surface.nodes_L, face, plane)) continue;
      is_cut = true;
      for (const std::int32_t node : face)
        if (lies_on(surface.nodes_L[std::size_t(node)], plane))
          blocked_[std::size_t(node)].push_back(plane.normal.normalized());
        else  // A corner of a bevel: wedges would end outside the plane.
          is_layer_boundary_[std::size_t(node)] = 1;
    }
    if (is_cut) continue;
    for (const std::int32_t node : face) is_layer_boundary_[std::size_t(node)] = 1;
  }
  for (std::vector<Vec3>& normals : blocked_) normals = orthonormal_basis(normals);
  is_fixed_ = is_layer_boundary_;
  for (const Face3& face : surface.faces)
    for (const std::int32_t node : face) is_fixed_[std::size_t(node)] = 1;
}

}  // namespace lefort::mesh::internal
