#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/fine_quadrature.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/faces/all_faces.h>
#include <lefort/mesh/element_faces.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <random>

namespace lefort::fem::test_elements {
namespace {

using Eigen::MatrixXd;
using mesh::ElementShape;
using mesh::FaceShape;

struct AnyPoint {
  double weight;
  VectorX N;
  MatrixXd dN_dxi;
};

/// An element or face without its static type, so that each test is compiled once.
struct AnyShape {
  std::string name;
  bool is_face = false;
  int corners = 0;
  MatrixXd nodes;  ///< Reference coordinates: 2 or 3 rows.
  std::function<VectorX(const VectorX&)> functions;
  std::function<MatrixXd(const VectorX&)> gradients;
  std::vector<AnyPoint> points;
  std::vector<AnyPoint> fine_points;

  [[nodiscard]] int dimension() const { return int(nodes.rows()); }
  [[nodiscard]] Index node_count() const { return nodes.cols(); }
};

template <class Points>
std::vector<AnyPoint> any_points(const Points& points) {
  std::vector<AnyPoint> all;
  for (const auto& point : points) all.push_back({point.weight, point.N, point.dN_dxi});
  return all;
}

template <class Shape>
AnyShape any_shape(const Shape& /*tag*/) {
  AnyShape shape;
  shape.corners = mesh::corner_count(Shape::kShape);
  shape.nodes = Shape::nodes();
  shape.functions = [](const VectorX& xi) -> VectorX { return Shape::functions(xi); };
  shape.gradients = [](const VectorX& xi) -> MatrixXd { return Shape::gradients(xi); };
  shape.points = any_points(Shape::quadrature());
  shape.fine_points = any_points(fine_quadrature<Shape>());
  return shape;
}

constexpr ElementShape kElements[] = {
    ElementShape::kTet4,  ElementShape::kPyramid5, ElementShape::kWedge6, ElementShape::kHex8,
    ElementShape::kTet10, ElementShape::kWedge15,  ElementShape::kHex20};
constexpr std::pair<FaceShape, const char*> kFaces[] = {{FaceShape::kTri3, "tri3"},
                                                        {FaceShape::kQuad4, "quad4"},
                                                        {FaceShape::kTri6, "tri6"},
                                                        {FaceShape::kQuad8, "quad8"}};

AnyShape shape_of(ElementShape element) {
  AnyShape shape = std::visit([](const auto& tag) { return any_shape(tag); }, element_of(element));
  shape.name = mesh::name_of(element);
  return shape;
}

AnyShape shape_of(FaceShape face) {
  AnyShape shape = std::visit([](const auto& tag) { return any_shape(tag); }, face_of(face));
  shape.is_face = true;
  for (const auto& [known, name] : kFaces)
    if (known == face) shape.name = name;
  return shape;
}

std::vector<AnyShape> all_shapes() {
  std::vector<AnyShape> all;
  for (const ElementShape element : kElements) all.push_back(shape_of(element));
  for (const auto& [face, name] : kFaces) all.push_back(shape_of(face));
  return all;
}

/// \returns an interior point: a mean of the nodes with random weights.
VectorX inner_point(const AnyShape& shape, std::mt19937& generator) {
  VectorX weights(shape.node_count());
  for (double& weight : weights) weight = 0.05 + double(generator() % 1000) / 1000.0;
  return shape.nodes * (weights / weights.sum());
}

double factorial(int n) { return n < 2 ? 1.0 : n * factorial(n - 1); }
/// \returns the integral of x^n over [-1, 1].
double on_line(int n) { return n % 2 == 0 ? 2.0 / (n + 1) : 0.0; }
/// \returns the integral of x^i y^j over the triangle.
double on_triangle(int i, int j) { return factorial(i) * factorial(j) / factorial(i + j + 2); }

/// \returns the integral of xi^i eta^j zeta^k over the reference element.
double integral(const AnyShape& shape, int i, int j, int k) {
  if (shape.is_face) return shape.corners == 3 ? on_triangle(i, j) : on_line(i) * on_line(j);
  switch (shape.corners) {
    case 4:
      return factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3);
    case 5:  // That of the square times that of (1 - zeta)^(i + j + 2) zeta^k, a beta function.
      return on_line(i) * on_line(j) * factorial(i + j + 2) * factorial(k) /
             factorial(i + j + k + 3);
    case 6:
      return on_triangle(i, j) * on_line(k);
    default:
      return on_line(i) * on_line(j) * on_line(k);
  }
}

/// Max degrees of the monomials that a rule integrates: in each coordinate, in the first two
/// together, and in all together.
struct Exactness {
  int in_each;
  int in_first_two;
  int in_all;
};

void expect_exact(const AnyShape& shape, const std::vector<AnyPoint>& points,
                  const Exactness& exact, int in_third) {
  for (int i = 0; i <= exact.in_each; ++i)
    for (int j = 0; j <= exact.in_each; ++j)
      for (int k = 0; k <= (shape.is_face ? 0 : in_third); ++k) {
        if (i + j > exact.in_first_two || i + j + k > exact.in_all) continue;
        double sum = 0.0;
        for (const AnyPoint& point : points) {
          const VectorX xi = shape.nodes * point.N;
          sum += point.weight * std::pow(xi[0], i) * std::pow(xi[1], j) *
                 (shape.is_face ? 1.0 : std::pow(xi[2], k));
        }
        EXPECT_NEAR(sum, integral(shape, i, j, k), 2e-14)
            << shape.name << ": " << i << " " << j << " " << k;
      }
}

TEST(Shapes, HaveTheNodeCountsOfTheMesh) {
  for (const ElementShape element : kElements)
    EXPECT_EQ(shape_of(element).node_count(), mesh::node_count(element));
  for (const auto& [face, name] : kFaces)
    EXPECT_EQ(shape_of(face).node_count(), mesh::node_count(face));
}

TEST(Shapes, FunctionsAreOneAtTheirNodeAndZeroAtTheOthers) {
  for (const AnyShape& shape : all_shapes())
    for (Index a = 0; a < shape.node_count(); ++a) {
      const VectorX N = shape.functions(shape.nodes.col(a));
      EXPECT_LT((N - VectorX::Unit(shape.node_count(), a)).norm(), 1e-15) << shape.name << a;
    }
}

TEST(Shapes, FunctionsSumToOneAndReproducePositions) {
  std::mt19937 generator(1);
  for (const AnyShape& shape : all_shapes())
    for (int n = 0; n < 50; ++n) {
      const VectorX xi = inner_point(shape, generator);
      const VectorX N = shape.functions(xi);
      EXPECT_NEAR(N.sum(), 1.0, 1e-14) << shape.name;
      EXPECT_LT((shape.nodes * N - xi).norm(), 1e-14) << shape.name;
    }
}

TEST(Shapes, GradientsAreThoseOfTheFunctions) {
  std::mt19937 generator(2);
  const double h = 1e-6;
  for (const AnyShape& shape : all_shapes())
    for (int n = 0; n < 50; ++n) {
      const VectorX xi = inner_point(shape, generator);
      const MatrixXd dN = shape.gradients(xi);
      for (int d = 0; d < shape.dimension(); ++d) {
        const VectorX step = h * VectorX::Unit(shape.dimension(), d);
        const VectorX change = shape.functions(xi + step) - shape.functions(xi - step);
        EXPECT_LT((dN.row(d).transpose() - change / (2 * h)).norm(), 1e-9) << shape.name;
      }
    }
}

TEST(Shapes, QuadraticShapesReproduceQuadraticFunctions) {
  std::mt19937 generator(6);
  for (const AnyShape& shape : all_shapes()) {
    if (shape.node_count() == shape.corners) continue;
    for (int n = 0; n < 20; ++n) {
      const VectorX xi = inner_point(shape, generator);
      const VectorX N = shape.functions(xi);
      const MatrixXd products = shape.nodes * N.asDiagonal() * shape.nodes.transpose();
      EXPECT_LT((products - xi * xi.transpose()).norm(), 1e-14) << shape.name;
    }
  }
}

TEST(Shapes, QuadraturePointsHaveTheFunctionsAtTheirPosition) {
  for (const AnyShape& shape : all_shapes())
    for (const auto* points : {&shape.points, &shape.fine_points})
      for (const AnyPoint& point : *points) {
        const VectorX xi = shape.nodes * point.N;
        EXPECT_LT((point.N - shape.functions(xi)).norm(), 1e-14) << shape.name;
        EXPECT_LT((point.dN_dxi - shape.gradients(xi)).norm(), 1e-13) << shape.name;
        EXPECT_GT(point.weight, 0.0) << shape.name;
      }
}

/// The degrees of exactness stated in the headers.
TEST(Shapes, TheRuleOfTheEnergyIsExactToItsDegree) {
  const auto check = [](const auto& which, const Exactness& exact, int in_third) {
    const AnyShape shape = shape_of(which);
    expect_exact(shape, shape.points, exact, in_third);
  };
  check(ElementShape::kTet4, {1, 1, 1}, 1);
  check(ElementShape::kTet10, {2, 2, 2}, 2);
  check(ElementShape::kPyramid5, {1, 1, 1}, 1);
  check(ElementShape::kWedge6, {2, 2, 5}, 3);
  check(ElementShape::kWedge15, {4, 4, 9}, 5);
  check(ElementShape::kHex8, {3, 6, 9}, 3);
  check(ElementShape::kHex20, {5, 10, 15}, 5);
  check(FaceShape::kTri3, {2, 2, 2}, 0);
  check(FaceShape::kTri6, {4, 4, 4}, 0);
  check(FaceShape::kQuad4, {3, 6, 6}, 0);
  check(FaceShape::kQuad8, {5, 10, 10}, 0);
}

TEST(Shapes, TheFineRuleIsExactToDegreeSeven) {
  for (const AnyShape& shape : all_shapes())
    expect_exact(shape, shape.fine_points, {kFineDegree, kFineDegree, kFineDegree}, kFineDegree);
}

/// For any shape of the pyramid; therefore one point along each ray is enough.
TEST(Pyramid5, GradientsAreConstantAlongEachRayFromTheApex) {
  for (const double zeta : {0.0, 0.5, 0.999}) {
    const Vec3 xi(0.3 * (1.0 - zeta), -0.8 * (1.0 - zeta), zeta);
    EXPECT_LT((Pyramid5::gradients(xi) - Pyramid5::gradients({0.3, -0.8, 0.0})).norm(), 1e-12);
  }
}

/// On a face, the functions of the element equal those of the face. So elements of different shapes
/// are compatible if their faces have the same nodes.
TEST(Elements, FunctionsOnAFaceAreThoseOfTheFace) {
  std::mt19937 generator(3);
  for (const ElementShape which : kElements) {
    const AnyShape element = shape_of(which);
    for (const mesh::LocalFace& local : mesh::faces_of(which)) {
      const AnyShape face = shape_of(local.shape);
      MatrixXd at(3, face.node_count());
      for (Index n = 0; n < face.node_count(); ++n)
        at.col(n) = element.nodes.col(local.nodes[std::size_t(n)]);
      for (int repeat = 0; repeat < 20; ++repeat) {
        const VectorX N_face = face.functions(inner_point(face, generator));
        VectorX expected = VectorX::Zero(element.node_count());
        for (Index n = 0; n < face.node_count(); ++n)
          expected[local.nodes[std::size_t(n)]] = N_face[n];
        EXPECT_LT((element.functions(at * N_face) - expected).norm(), 1e-14) << element.name;
      }
    }
  }
}

/// The nodes of the reference element, displaced so that faces are warped and edges curved. Edges
/// of tet10 stay straight, as its rule requires.
MatrixXd bent(const AnyShape& shape, unsigned seed) {
  std::mt19937 generator(seed);
  const auto number = [&] { return 0.2 * double(generator() % 1000) / 1000.0 - 0.1; };
  if (shape.name == "tet10") return (Mat3::Identity() + Mat3::NullaryExpr(number)) * shape.nodes;
  return shape.nodes + MatrixXd::NullaryExpr(3, shape.node_count(), number);
}

/// Integrals over the surface of an element, by the rules of its faces.
struct Surface {
  double flux = 0.0;         ///< Of x / 3: the volume.
  Vec3 area = Vec3::Zero();  ///< Sum of all area vectors.
  MatrixXd area_of_node;     ///< Integral of N_a over the area vectors.
  bool points_out = true;
};

Surface surface_of(ElementShape which, const MatrixXd& X) {
  Surface surface;
  surface.area_of_node = MatrixXd::Zero(3, X.cols());
  const Vec3 middle = X.rowwise().mean();
  for (const mesh::LocalFace& local : mesh::faces_of(which)) {
    const AnyShape face = shape_of(local.shape);
    MatrixXd x(3, face.node_count());
    for (Index n = 0; n < face.node_count(); ++n) x.col(n) = X.col(local.nodes[std::size_t(n)]);
    for (const AnyPoint& point : face.points) {
      const Vec3 area = area_vector_mm2(x * point.dN_dxi.transpose(), point.weight);
      const Vec3 at = x * point.N;
      surface.points_out = surface.points_out && area.dot(at - middle) > 0.0;
      surface.flux += area.dot(at) / 3.0;
      surface.area += area;
      for (Index n = 0; n < face.node_count(); ++n)
        surface.area_of_node.col(local.nodes[std::size_t(n)]) += point.N[n] * area;
    }
  }
  return surface;
}

TEST(Elements, VolumeIsTheFluxThroughTheOutwardFaces) {
  for (const ElementShape which : kElements) {
    const AnyShape shape = shape_of(which);
    const MatrixXd X = bent(shape, 4);
    double volume = 0.0;
    for (const AnyPoint& point : shape.points)
      volume += point.weight * Mat3(X * point.dN_dxi.transpose()).determinant();
    const Surface surface = surface_of(which, X);
    EXPECT_TRUE(surface.points_out) << shape.name;
    EXPECT_NEAR(surface.flux, volume, 1e-13) << shape.name;
    EXPECT_LT(surface.area.norm(), 1e-13) << shape.name;
  }
}

/// The integral of dN_a/dX over the element is that of N_a over its curved faces: the condition of
/// the patch test for a rule.
TEST(Elements, TheRuleIntegratesGradientsLikeTheFaces) {
  for (const ElementShape which : kElements) {
    const AnyShape shape = shape_of(which);
    const MatrixXd X = bent(shape, 5);
    MatrixXd inside = MatrixXd::Zero(3, shape.node_count());
    for (const AnyPoint& point : shape.points) {
      const Mat3 dX_dxi = X * point.dN_dxi.transpose();
      inside += point.weight * dX_dxi.determinant() * dX_dxi.inverse().transpose() * point.dN_dxi;
    }
    EXPECT_LT((inside - surface_of(which, X).area_of_node).norm(), 1e-13) << shape.name;
  }
}

}  // namespace
}  // namespace lefort::fem::test_elements
