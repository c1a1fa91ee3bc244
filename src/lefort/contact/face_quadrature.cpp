#include <lefort/contact/face_quadrature.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/fem/faces/all_faces.h>

#include <algorithm>
#include <cmath>

namespace lefort::contact {
namespace {

/// Twelve points in a triangle, of degree 6 (\cite dunavant1985), and 3 x 3 in a quadrilateral. The
/// gap is not a polynomial; dense points keep an edge of the bone from passing between them.
template <class Shape>
FaceQuadrature rule_of() {
  FaceQuadrature rule;
  if constexpr (mesh::corner_count(Shape::kShape) == 3)
    rule.points = quadrature_points<Shape>(fem::triangle_12());
  else
    rule.points = quadrature_points<Shape>(fem::product(fem::gauss_3(), fem::gauss_3()));
  for (const QuadraturePoint& point : rule.points) {
    double bound = 0.0;
    for (const double N : point.N) bound += std::abs(N);
    rule.displacement_bound = std::max(rule.displacement_bound, bound);
  }
  return rule;
}

}  // namespace

const FaceQuadrature& face_quadrature(std::size_t number) {
  static const std::array<FaceQuadrature, 4> rules{rule_of<fem::Tri3>(), rule_of<fem::Quad4>(),
                                                   rule_of<fem::Tri6>(), rule_of<fem::Quad8>()};
  return rules[number];
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
