#include <lefort/core/check.h>
#include <lefort/core/decompositions.h>
#include <lefort/fem/elements/fine_quadrature.h>

#include <array>
#include <cmath>

namespace lefort::fem {
namespace {

constexpr int kCount = 4;

struct Point1 {
  double t;
  double weight;
};
using Rule1 = std::array<Point1, kCount>;

/// Gauss rule for the integral of f(t) (1 - t)^alpha over [0, 1], from the eigenvalues of the
/// Jacobi matrix of the orthogonal polynomials (\cite golub1969). On [-1, 1], with the weight (1 -
/// x)^a, they have the recurrence coefficients below.
Rule1 gauss_jacobi(double alpha) {
  Eigen::Vector4d diagonal;
  Vec3 subdiagonal;
  for (int n = 0; n < kCount; ++n) {
    const double s = 2.0 * n + alpha;
    diagonal[n] = n == 0 ? -alpha / (alpha + 2.0) : -alpha * alpha / (s * (s + 2.0));
    if (n == 0) continue;
    const double m = n * (n + alpha);
    subdiagonal[n - 1] = 2.0 * m / (s * std::sqrt((s + 1.0) * (s - 1.0)));
  }
  const SymmetricEigen<kCount> eigen = tridiagonal_eigen(diagonal, subdiagonal);
  Rule1 rule;
  for (int q = 0; q < kCount; ++q) {
    const double first = eigen.vectors(0, q);
    rule[std::size_t(q)] = {0.5 * (1.0 + eigen.values[q]), first * first / (alpha + 1.0)};
  }
  return rule;
}

/// On [-1, 1].
Rule1 gauss() {
  Rule1 rule = gauss_jacobi(0.0);
  for (Point1& point : rule) point = {2.0 * point.t - 1.0, 2.0 * point.weight};
  return rule;
}

std::vector<RulePoint<2>> square() {
  std::vector<RulePoint<2>> rule;
  for (const Point1& y : gauss())
    for (const Point1& x : gauss()) rule.push_back({{x.t, y.t}, x.weight * y.weight});
  return rule;
}

/// The square t, s in [0, 1] collapsed to a point at s = 1: area element 1 - s.
std::vector<RulePoint<2>> triangle() {
  std::vector<RulePoint<2>> rule;
  for (const Point1& s : gauss_jacobi(1.0))
    for (const Point1& t : gauss_jacobi(0.0))
      rule.push_back({{t.t * (1.0 - s.t), s.t}, s.weight * t.weight});
  return rule;
}

/// `base` extruded along the third coordinate.
std::vector<RulePoint<3>> prism(const std::vector<RulePoint<2>>& base) {
  std::vector<RulePoint<3>> rule;
  for (const Point1& z : gauss())
    for (const RulePoint<2>& p : base)
      rule.push_back({Vec3(p.xi[0], p.xi[1], z.t), p.weight * z.weight});
  return rule;
}

/// `base` collapsed to a point at height 1: volume element (1 - zeta)^2.
std::vector<RulePoint<3>> cone(const std::vector<RulePoint<2>>& base) {
  std::vector<RulePoint<3>> rule;
  for (const Point1& z : gauss_jacobi(2.0))
    for (const RulePoint<2>& p : base)
      rule.push_back(
          {Vec3(p.xi[0] * (1.0 - z.t), p.xi[1] * (1.0 - z.t), z.t), p.weight * z.weight});
  return rule;
}

}  // namespace

std::vector<RulePoint<3>> fine_rule(mesh::ElementShape shape) {
  switch (shape) {
    case mesh::ElementShape::kTet4:
    case mesh::ElementShape::kTet10:
      return cone(triangle());
    case mesh::ElementShape::kPyramid5:
      return cone(square());
    case mesh::ElementShape::kWedge6:
    case mesh::ElementShape::kWedge15:
      return prism(triangle());
    case mesh::ElementShape::kHex8:
    case mesh::ElementShape::kHex20:
      return prism(square());
  }
  LEFORT_CHECK(false);
  return {};
}

std::vector<RulePoint<2>> fine_rule(mesh::FaceShape shape) {
  switch (shape) {
    case mesh::FaceShape::kTri3:
    case mesh::FaceShape::kTri6:
      return triangle();
    case mesh::FaceShape::kQuad4:
    case mesh::FaceShape::kQuad8:
      return square();
  }
  LEFORT_CHECK(false);
  return {};
}

}  // namespace lefort::fem
