#include <lefort/core/check.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/snap_boundary_to_level.h>

#include <cmath>

namespace lefort::mesh {
namespace {

/// \returns area-weighted outward normals of the boundary nodes; zero for interior nodes.
std::vector<Vec3> node_normals(const VolumeMesh& mesh, const std::vector<Face3>& faces) {
  std::vector<Vec3> normals(std::size_t(mesh.node_count()), Vec3::Zero());
  for (const auto& [a, b, c] : faces) {
    const Vec3& p = mesh.nodes_L[std::size_t(a)];
    const Vec3 area = (mesh.nodes_L[std::size_t(b)] - p).cross(mesh.nodes_L[std::size_t(c)] - p);
    for (const std::int32_t node : {a, b, c}) normals[std::size_t(node)] += area;
  }
  return normals;
}

/// \returns for each node the elements around it.
std::vector<std::vector<Index>> elements_of_nodes(const VolumeMesh& mesh) {
  std::vector<std::vector<Index>> elements(std::size_t(mesh.node_count()));
  const ElementBlock& block = mesh.blocks[0];
  for (std::size_t n = 0; n < block.nodes.size(); ++n)
    elements[std::size_t(block.nodes[n])].push_back(Index(n / 4));
  return elements;
}

double volume_mm3(const VolumeMesh& mesh, Index element) {
  const std::int32_t* tet = mesh.blocks[0].element(element);
  const Vec3& a = mesh.nodes_L[std::size_t(tet[0])];
  return (mesh.nodes_L[std::size_t(tet[1])] - a)
             .cross(mesh.nodes_L[std::size_t(tet[2])] - a)
             .dot(mesh.nodes_L[std::size_t(tet[3])] - a) /
         6.0;
}

/// Moves the node by the largest of the fractions of `shift` at which every element keeps at least
/// kMinVolumeFraction of its volume. \returns whether it moved all the way.
bool move_node(VolumeMesh& mesh, std::size_t node, const Vec3& shift,
               const std::vector<Index>& elements) {
  constexpr double kMinVolumeFraction = 0.2;  // Heuristic.
  const Vec3 start = mesh.nodes_L[node];
  std::vector<double> before_mm3;
  for (const Index e : elements) before_mm3.push_back(volume_mm3(mesh, e));
  const auto is_allowed = [&] {
    for (std::size_t i = 0; i < elements.size(); ++i)
      if (!(volume_mm3(mesh, elements[i]) >= kMinVolumeFraction * before_mm3[i])) return false;
    return true;
  };
  for (const double fraction : {1.0, 0.5, 0.25}) {
    mesh.nodes_L[node] = start + fraction * shift;
    if (is_allowed()) return fraction == 1.0;
  }
  mesh.nodes_L[node] = start;
  return false;
}

}  // namespace

Index snap_boundary_to_level(VolumeMesh& mesh, const InsidePredicate& is_inside_L,
                             double max_distance_mm, double tolerance_mm) {
  LEFORT_CHECK(mesh.blocks.size() == 1 && mesh.blocks[0].shape == ElementShape::kTet4);
  LEFORT_CHECK(tolerance_mm > 0.0 && max_distance_mm >= tolerance_mm);
  const std::vector<Face> faces = boundary_faces(mesh);
  const std::vector<Vec3> normals = node_normals(mesh, triangles_of(faces));
  const std::vector<std::vector<Index>> elements = elements_of_nodes(mesh);
  Index incomplete = 0;
  for (const std::int32_t n : nodes_of_faces(faces)) {
    const auto node = std::size_t(n);
    const double length = normals[node].norm();
    if (length == 0.0) continue;
    const Vec3 normal = normals[node] / length;
    const auto change_mm =
        find_zero_crossing(mesh.nodes_L[node], normal, is_inside_L, max_distance_mm, tolerance_mm);
    if (!change_mm || std::abs(*change_mm) <= tolerance_mm) continue;
    if (!move_node(mesh, node, *change_mm * normal, elements[node])) ++incomplete;
  }
  return incomplete;
}

}  // namespace lefort::mesh
