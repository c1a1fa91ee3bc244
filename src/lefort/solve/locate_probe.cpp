#include <lefort/core/check.h>
#include <lefort/core/decompositions.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/gradient_products.h>
#include <lefort/solve/find_sets.h>
#include <lefort/solve/locate_probe.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lefort::solve {
namespace {

/// Distance of a point outside its reference element, in reference coordinates; negative inside.
double outside_by(mesh::ElementShape shape, const Vec3& xi) {
  using mesh::ElementShape;
  switch (shape) {
    case ElementShape::kTet4:
    case ElementShape::kTet10:
      return std::max(-xi.minCoeff(), xi.sum() - 1.0);
    case ElementShape::kWedge6:
    case ElementShape::kWedge15:
      return std::max({-xi[0], -xi[1], xi[0] + xi[1] - 1.0, std::abs(xi[2]) - 1.0});
    case ElementShape::kPyramid5:
      return std::max({-xi[2], std::abs(xi[0]) + xi[2] - 1.0, std::abs(xi[1]) + xi[2] - 1.0});
    case ElementShape::kHex8:
    case ElementShape::kHex20:
      return xi.cwiseAbs().maxCoeff() - 1.0;
  }
  return std::numeric_limits<double>::infinity();
}

/// Reference coordinates of a point, by Newton's method from the center of the element.
///
/// \param X, p  nodes and point relative to a nearby point, to avoid cancellation.
template <class Element>
std::optional<Vec3> reference_coordinates(const Eigen::Matrix<double, 3, Element::kNodes>& X,
                                          const Vec3& p) {
  constexpr int kIterations = 30;
  constexpr double kConverged = 1e-10;
  constexpr double kStagnated = 1e-6;  // Smaller steps that no longer shrink count as converged.
  constexpr double kDiverged = 10.0;   // Reference coordinates this large lie in another element.
  Vec3 xi = Element::nodes().rowwise().mean();
  double last_step = std::numeric_limits<double>::infinity();
  for (int n = 0; n < kIterations; ++n) {
    const Mat3 dX_dxi = fem::sum_of_dyads<Element::kNodes>(X.data(), Element::gradients(xi).data());
    const Vec3 step = solve_by_lu(dX_dxi, p - X * Element::functions(xi));
    if (!step.allFinite()) return std::nullopt;
    xi += step;
    if (xi.norm() > kDiverged) return std::nullopt;
    const double length = step.norm();
    if (length < kConverged || (length < kStagnated && length >= last_step)) return xi;
    last_step = length;
  }
  return std::nullopt;
}

/// The best element for a point so far.
struct Candidate {
  double outside_by = 1e-6;  ///< Reference coordinates: a point on the boundary counts as inside.
  ProbePlace place;
};

template <class Element>
void test_element(const mesh::VolumeMesh& mesh, const std::int32_t* nodes, const Vec3& p_L,
                  Candidate& best) {
  constexpr double kMargin = 0.25;  // Of the box: faces of quadratic elements are curved.
  Eigen::Matrix<double, 3, Element::kNodes> X;
  Box3 box_L;
  for (int a = 0; a < Element::kNodes; ++a) {
    X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
    box_L.extend(Vec3(X.col(a)));
  }
  const double margin_mm = kMargin * box_L.sizes().maxCoeff();
  if (box_L.squaredExteriorDistance(p_L) > margin_mm * margin_mm) return;
  const Vec3 first_L = X.col(0);
  X.colwise() -= first_L;
  const auto xi = reference_coordinates<Element>(X, p_L - first_L);
  if (!xi) return;
  const double outside = outside_by(Element::kShape, *xi);
  if (!(outside < best.outside_by)) return;
  best.outside_by = outside;
  best.place.at_L = p_L;
  best.place.nodes.assign(nodes, nodes + Element::kNodes);
  const Eigen::Matrix<double, Element::kNodes, 1> N = Element::functions(*xi);
  best.place.weights.assign(N.data(), N.data() + Element::kNodes);
}

Result<ProbePlace> locate_node(const mesh::VolumeMesh& mesh, std::int32_t node) {
  const std::vector<char> used = nodes_of_elements(mesh);
  if (node < 0 || Index(node) >= mesh.node_count() || used[std::size_t(node)] == 0)
    return fail(
        ErrorCode::kPlanInvalid,
        fmt::format("no element has node {}; the nodes are 0 to {}", node, mesh.node_count() - 1));
  return ProbePlace{mesh.nodes_L[std::size_t(node)], {node}, {1.0}};
}

Result<ProbePlace> locate_point(const mesh::VolumeMesh& mesh, const Vec3& p_L) {
  Candidate best;
  for (const mesh::ElementBlock& block : mesh.blocks)
    std::visit(
        [&]<class Element>(const Element&) {
          for (Index e = 0; e < block.element_count(); ++e)
            test_element<Element>(mesh, block.element(e), p_L, best);
        },
        fem::element_of(block.shape));
  if (!best.place.nodes.empty()) return best.place;
  std::size_t nearest = 0;
  for (std::size_t n = 0; n < mesh.nodes_L.size(); ++n)
    if ((mesh.nodes_L[n] - p_L).squaredNorm() < (mesh.nodes_L[nearest] - p_L).squaredNorm())
      nearest = n;
  const Vec3& at_L = mesh.nodes_L[nearest];
  return fail(ErrorCode::kPlanInvalid,
              fmt::format("({:.3f}, {:.3f}, {:.3f}) mm lies in no element; the closest node is {} "
                          "at ({:.3f}, {:.3f}, {:.3f}) mm",
                          p_L.x(), p_L.y(), p_L.z(), nearest, at_L.x(), at_L.y(), at_L.z()));
}

}  // namespace

Result<ProbePlace> locate_probe(const mesh::VolumeMesh& mesh,
                                const std::variant<std::int32_t, Vec3>& at) {
  if (const auto* node = std::get_if<std::int32_t>(&at)) return locate_node(mesh, *node);
  return locate_point(mesh, std::get<Vec3>(at));
}

Vec3 displacement_of(const ProbePlace& probe, const VectorX& u) {
  Vec3 displacement = Vec3::Zero();
  for (std::size_t a = 0; a < probe.nodes.size(); ++a)
    displacement += probe.weights[a] * u.segment<3>(3 * Index(probe.nodes[a]));
  return displacement;
}

}  // namespace lefort::solve
