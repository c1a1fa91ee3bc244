#include <lefort/fem/faces/all_faces.h>
#include <lefort/fem/loads/follower_pressure.h>
#include <lefort/fem/loads/validate_load_faces.h>
#include <lefort/mesh/element_faces.h>

#include <algorithm>
#include <map>
#include <utility>

namespace lefort::fem {
namespace {

/// \returns [v]x with [v]x w = v x w.
Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Adds the contribution of one point. With current tangents g1, g2 and reference tangents G1, G2,
/// the normal on the straight path, n(t), is a polynomial of degree 2 whose mean is
///   (2 G1 x G2 + G1 x g2 + g1 x G2 + 2 g1 x g2) / 6
template <class Shape>
void add_point(const FaceNodes<Shape>& X, const FaceNodes<Shape>& x,
               const QuadraturePoint<Shape::kNodes, 2>& point, double pressure_mpa,
               LocalEquations& local) {
  const Eigen::Matrix<double, 3, 2> G = tangents<Shape>(X, point);
  const Eigen::Matrix<double, 3, 2> g = tangents<Shape>(x, point);
  const Vec3 n = g.col(0).cross(g.col(1));
  const Vec3 mean = (2.0 * G.col(0).cross(G.col(1)) + G.col(0).cross(g.col(1)) +
                     g.col(0).cross(G.col(1)) + 2.0 * n) /
                    6.0;
  const double p = pressure_mpa * point.weight;
  const Vec3 u = (x - X) * point.N;
  local.energy_mj += p * u.dot(mean);
  Eigen::Map<FaceNodes<Shape>>(local.residual_n.data()).noalias() += p * n * point.N.transpose();
  if (!local.wants_stiffness() || local.tangent == Tangent::kStabilized) return;

  // dn = dg1 x g2 + g1 x dg2: dn/dx_b = dN_b/deta [g1]x - dN_b/dxi [g2]x, antisymmetric.
  const double sign = local.tangent == Tangent::kAntisymmetric ? 1.0 : -1.0;
  const Mat3 g1 = cross_matrix(g.col(0));
  const Mat3 g2 = cross_matrix(g.col(1));
  for (int b = 0; b < Shape::kNodes; ++b)
    for (int a = 0; a < Shape::kNodes; ++a) {
      // Half of N_a dn/dx_b, plus or minus half of its transpose with a and b exchanged.
      const double of_g1 = point.N[a] * point.dN_dxi(1, b) + sign * point.N[b] * point.dN_dxi(1, a);
      const double of_g2 = point.N[a] * point.dN_dxi(0, b) + sign * point.N[b] * point.dN_dxi(0, a);
      local.stiffness_n_per_mm.template block<3, 3>(3 * a, 3 * b) +=
          0.5 * p * (of_g1 * g1 - of_g2 * g2);
    }
}

/// The nodes of one edge of a face: its ends, the lower first, and its mid-edge node or -1.
using FaceEdge = std::array<std::int32_t, 3>;

std::vector<FaceEdge> edges_of(const mesh::Face& face) {
  const auto corners = std::size_t(mesh::corner_count(face.shape));
  const bool has_mid_nodes = mesh::nodes_of(face).size() > corners;
  std::vector<FaceEdge> edges;
  for (std::size_t a = 0; a < corners; ++a) {
    const auto [low, high] = std::minmax(face.nodes[a], face.nodes[(a + 1) % corners]);
    edges.push_back({low, high, has_mid_nodes ? face.nodes[corners + a] : -1});
  }
  return edges;
}

/// \returns the nodes of edges that do not have exactly two faces, ascending, each once.
std::vector<std::int32_t> border_nodes(std::span<const mesh::Face> faces) {
  std::map<FaceEdge, int> uses;
  for (const mesh::Face& face : faces)
    for (const FaceEdge& edge : edges_of(face)) ++uses[edge];
  std::vector<std::int32_t> nodes;
  for (const auto& [edge, count] : uses)
    if (count != 2)
      for (const std::int32_t node : edge)
        if (node >= 0) nodes.push_back(node);
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace

Result<std::unique_ptr<FollowerPressure>> FollowerPressure::build(std::span<const Vec3> nodes_L,
                                                                  std::vector<mesh::Face> faces) {
  LEFORT_TRY_VOID(validate_load_faces(nodes_L, faces));
  std::unique_ptr<FollowerPressure> pressure(new FollowerPressure());
  for (const mesh::Face& face : faces) {
    std::array<Vec3, 8>& reference_L = pressure->reference_L_.emplace_back();
    for (std::size_t a = 0; a < mesh::nodes_of(face).size(); ++a)
      reference_L[a] = nodes_L[std::size_t(face.nodes[a])];
  }
  pressure->border_nodes_ = border_nodes(faces);
  pressure->faces_ = std::move(faces);
  return pressure;
}

std::span<const std::int32_t> FollowerPressure::nodes(Index item) const {
  return mesh::nodes_of(faces_[std::size_t(item)]);
}

bool FollowerPressure::evaluate(Index item, std::span<const Vec3> x_L,
                                LocalEquations& local) const {
  std::visit(
      [&]<class Shape>(const Shape&) {
        const Eigen::Map<const FaceNodes<Shape>> X(reference_L_[std::size_t(item)].data()->data());
        const Eigen::Map<const FaceNodes<Shape>> x(x_L.data()->data());
        static const auto kQuadrature = Shape::quadrature();
        for (const auto& point : kQuadrature) add_point<Shape>(X, x, point, pressure_mpa_, local);
      },
      face_of(faces_[std::size_t(item)].shape));
  return true;
}

bool FollowerPressure::is_conservative(const DofMap& dofs) const {
  return std::ranges::all_of(border_nodes_, [&](std::int32_t node) {
    for (int c = 0; c < 3; ++c)
      if (dofs.free_number(3 * Index(node) + c) >= 0) return false;
    return true;
  });
}

}  // namespace lefort::fem
