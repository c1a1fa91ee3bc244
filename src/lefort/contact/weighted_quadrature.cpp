#include <lefort/contact/weighted_quadrature.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/fem/faces/all_faces.h>

#include <algorithm>

namespace lefort::contact {
namespace {

using Triangles = std::vector<std::array<std::uint8_t, 3>>;

/// \param count  of nodes.
Triangles triangles_of(int count) {
  switch (count) {
    case 3:
      return {{0, 1, 2}};
    case 4:
      return {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    case 6:
      return {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
    default:
      return {{0, 4, 8}, {4, 1, 8}, {1, 5, 8}, {5, 2, 8},
              {2, 6, 8}, {6, 3, 8}, {3, 7, 8}, {7, 0, 8}};
  }
}

template <class Shape>
FaceDivision divide() {
  constexpr int kNodes = Shape::kNodes, kCorners = mesh::corner_count(Shape::kShape);
  FaceDivision division{.vertices = {}, .triangles = triangles_of(kNodes)};
  for (int a = 0; a < kNodes; ++a) {
    DivisionVertex& vertex = division.vertices.emplace_back();
    vertex.N[std::size_t(a)] = vertex.hat[std::size_t(a)] = 1.0;
  }
  if constexpr (kCorners == 4) {
    DivisionVertex& center = division.vertices.emplace_back();
    const auto N = Shape::functions(Eigen::Vector2d::Zero());
    for (int a = 0; a < kNodes; ++a) {
      center.N[std::size_t(a)] = N[a];
      center.hat[std::size_t(a)] = kNodes == kCorners || a >= kCorners ? 0.25 : 0.0;
    }
  }
  return division;
}

template <class Shape>
WeightedPoint point_at(const Eigen::Vector2d& xi, double weight) {
  WeightedPoint point;
  point.at.weight = weight;
  const auto N = Shape::functions(xi);
  for (int a = 0; a < Shape::kNodes; ++a) point.at.N[std::size_t(a)] = N[a];
  point.at.dN_dxi.template leftCols<Shape::kNodes>() = Shape::gradients(xi);
  return point;
}

/// Dual functions of the linear triangle.
std::array<double, 3> dual_of_triangle(const std::array<double, 3>& L) {
  return {4.0 * L[0] - 1.0, 4.0 * L[1] - 1.0, 4.0 * L[2] - 1.0};
}

/// Dual functions of the bilinear quadrilateral: products of 2 N_1 - N_2 and 2 N_2 - N_1.
std::array<double, 4> dual_of_square(const std::array<double, kMaxFaceNodes>& N) {
  return {4.0 * N[0] - 2.0 * N[1] + N[2] - 2.0 * N[3], 4.0 * N[1] - 2.0 * N[2] + N[3] - 2.0 * N[0],
          4.0 * N[2] - 2.0 * N[3] + N[0] - 2.0 * N[1], 4.0 * N[3] - 2.0 * N[0] + N[1] - 2.0 * N[2]};
}

template <class Shape>
std::vector<QuadraturePoint> linear_points() {
  if constexpr (Shape::kNodes == 3)
    return quadrature_points<Shape>(fem::triangle_6());
  else
    return face_quadrature(std::size_t(Shape::kShape)).points;
}

/// Linear faces: six points in a triangle, of degree 4 (\cite dunavant1985); in a quadrilateral the
/// points of face_quadrature().
template <class Shape>
std::vector<WeightedPoint> linear_rule() {
  std::vector<WeightedPoint> rule;
  for (const QuadraturePoint& at : linear_points<Shape>()) {
    WeightedPoint& point = rule.emplace_back();
    point.at = at;
    if constexpr (Shape::kNodes == 3) {
      const auto dual = dual_of_triangle({at.N[0], at.N[1], at.N[2]});
      std::copy(dual.begin(), dual.end(), point.M.begin());
    } else {
      const auto dual = dual_of_square(at.N);
      std::copy(dual.begin(), dual.end(), point.M.begin());
    }
  }
  return rule;
}

/// Quadratic faces: a rule on each triangle of the division. Three points are exact to degree 2:
/// for the product of a weight and a hat function on a flat tri6. A quad8 has six points, as its
/// shape functions are of degree 3.
template <class Shape>
std::vector<WeightedPoint> divided_rule() {
  std::vector<WeightedPoint> rule;
  const FaceDivision division = divide<Shape>();
  const auto position = [&](std::size_t vertex) -> Eigen::Vector2d {
    if (vertex < std::size_t(Shape::kNodes)) return Shape::nodes().col(Index(vertex));
    return Eigen::Vector2d::Zero();
  };
  const auto add = [&](const std::array<std::uint8_t, 3>& triangle, const auto& points) {
    const Eigen::Vector2d a = position(triangle[0]);
    Eigen::Matrix2d edges;
    edges << position(triangle[1]) - a, position(triangle[2]) - a;
    for (const auto& [xi, weight] : points) {
      WeightedPoint point =
          point_at<Shape>(Eigen::Vector2d(a + edges * xi), weight * edges.determinant());
      const std::array<double, 3> L = dual_of_triangle({1.0 - xi.sum(), xi[0], xi[1]});
      for (std::size_t v = 0; v < 3; ++v)
        for (std::size_t n = 0; n < kMaxFaceNodes; ++n)
          point.M[n] += L[v] * division.vertices[triangle[v]].hat[n];
      rule.push_back(point);
    }
  };
  for (const auto& triangle : division.triangles)
    if constexpr (mesh::corner_count(Shape::kShape) == 3)
      add(triangle, fem::triangle_3());
    else
      add(triangle, fem::triangle_6());
  return rule;
}

}  // namespace

std::span<const WeightedPoint> weighted_quadrature(mesh::FaceShape shape) {
  static const std::array<std::vector<WeightedPoint>, 4> rules{
      linear_rule<fem::Tri3>(), linear_rule<fem::Quad4>(), divided_rule<fem::Tri6>(),
      divided_rule<fem::Quad8>()};
  return rules[std::size_t(shape)];
}

const FaceDivision& face_division(mesh::FaceShape shape) {
  static const std::array<FaceDivision, 4> divisions{divide<fem::Tri3>(), divide<fem::Quad4>(),
                                                     divide<fem::Tri6>(), divide<fem::Quad8>()};
  return divisions[std::size_t(shape)];
}

}  // namespace lefort::contact
