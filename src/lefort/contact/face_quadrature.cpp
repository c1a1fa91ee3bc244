#include <lefort/contact/face_quadrature.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/fem/faces/all_faces.h>

#include <algorithm>

namespace lefort::contact {
namespace {

/// Six points in a triangle, of degree 4 (\cite dunavant1985), and 3 x 3 in a quadrilateral. The
/// gap is not a polynomial; dense points keep an edge of the bone from passing between them.
template <class Shape>
FaceQuadrature rule_of() {
  FaceQuadrature rule;
  const auto add = [&](const auto& points) {
    for (const auto& known : fem::at_points<Shape>(points)) {
      QuadraturePoint& point = rule.points.emplace_back();
      point.weight = known.weight;
      for (int a = 0; a < Shape::kNodes; ++a) point.N[std::size_t(a)] = known.N[a];
      point.dN_dxi.template leftCols<Shape::kNodes>() = known.dN_dxi;
      rule.displacement_bound = std::max(rule.displacement_bound, known.N.cwiseAbs().sum());
    }
  };
  if constexpr (mesh::corner_count(Shape::kShape) == 3)
    add(fem::triangle_6());
  else
    add(fem::product(fem::gauss_3(), fem::gauss_3()));
  return rule;
}

/// One point at a node.
FaceQuadrature node_rule() {
  FaceQuadrature rule;
  rule.points.emplace_back().weight = 1.0;
  rule.points.back().N[0] = 1.0;
  return rule;
}

}  // namespace

const FaceQuadrature& face_quadrature(std::size_t number) {
  static const std::array<FaceQuadrature, kNodeRule + 1> rules{
      rule_of<fem::Tri3>(), rule_of<fem::Quad4>(), rule_of<fem::Tri6>(), rule_of<fem::Quad8>(),
      node_rule()};
  return rules[number];
}

double lumped_weight(mesh::FaceShape shape, std::size_t a) {
  switch (shape) {
    case mesh::FaceShape::kTri3:
      return 1.0 / 3.0;
    case mesh::FaceShape::kQuad4:
      return 1.0 / 4.0;
    case mesh::FaceShape::kTri6:
      return a < 3 ? 1.0 / 12.0 : 1.0 / 4.0;
    case mesh::FaceShape::kQuad8:
      return a < 4 ? 1.0 / 12.0 : 1.0 / 6.0;
  }
  return 0.0;
}

Vec3 interpolate(const QuadraturePoint& point, std::span<const Vec3> x_L) {
  Vec3 p_L = point.N[0] * x_L[0];
  for (std::size_t a = 1; a < x_L.size(); ++a) p_L += point.N[a] * x_L[a];
  return p_L;
}

double area_mm2(const QuadraturePoint& point, std::span<const Vec3> x_L) {
  Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t a = 0; a < x_L.size(); ++a)
    tangents += x_L[a] * point.dN_dxi.col(Index(a)).transpose();
  return point.weight * tangents.col(0).cross(tangents.col(1)).norm();
}

}  // namespace lefort::contact
