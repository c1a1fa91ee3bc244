#include <lefort/fem/elements/tet10.h>
#include <lefort/fem/elements/tet4.h>

#include <gtest/gtest.h>

namespace lefort::fem {
namespace {

template <class Element>
Eigen::Matrix<double, 3, Element::kNodes> reference_nodes();

template <>
Eigen::Matrix<double, 3, 4> reference_nodes<Tet4>() {
  Eigen::Matrix<double, 3, 4> nodes;
  nodes << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  return nodes;
}

template <>
Eigen::Matrix<double, 3, 10> reference_nodes<Tet10>() {
  Eigen::Matrix<double, 3, 10> nodes;
  nodes << 0, 1, 0, 0, .5, .5, 0, 0, .5, 0,  //
      0, 0, 1, 0, 0, .5, .5, 0, 0, .5,       //
      0, 0, 0, 1, 0, 0, 0, .5, .5, .5;
  return nodes;
}

template <class Element>
class Elements : public testing::Test {};
using AllElements = testing::Types<Tet4, Tet10>;
TYPED_TEST_SUITE(Elements, AllElements);

TYPED_TEST(Elements, HaveAsManyNodesAsTheMeshSays) {
  EXPECT_EQ(TypeParam::kNodes, mesh::node_count(TypeParam::kShape));
}

TYPED_TEST(Elements, WeightsSumToTheVolumeOfTheReferenceTetrahedron) {
  double volume = 0.0;
  for (const auto& point : TypeParam::quadrature()) volume += point.weight;
  EXPECT_NEAR(volume, 1.0 / 6.0, 1e-15);
}

TYPED_TEST(Elements, ReproduceConstantAndLinearFunctions) {
  for (const auto& point : TypeParam::quadrature()) {
    EXPECT_LT(point.dN_dxi.rowwise().sum().norm(), 1e-14);
    const Eigen::Matrix3d dxi_dxi = reference_nodes<TypeParam>() * point.dN_dxi.transpose();
    EXPECT_LT((dxi_dxi - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  }
}

TEST(Tet10, IntegratesTheGradientOfAQuadraticFunction) {
  // f = xi^2 + 3 xi eta - 2 zeta^2; the integral of xi over the tetrahedron is 1/24.
  const auto nodes = reference_nodes<Tet10>();
  const Eigen::RowVectorXd f = nodes.row(0).array().square() +
                               3.0 * nodes.row(0).array() * nodes.row(1).array() -
                               2.0 * nodes.row(2).array().square();
  Eigen::Vector3d integral = Eigen::Vector3d::Zero();
  for (const auto& point : Tet10::quadrature())
    integral += point.weight * point.dN_dxi * f.transpose();
  EXPECT_LT((integral - Eigen::Vector3d(5.0, 3.0, -4.0) / 24.0).norm(), 1e-14);
}

}  // namespace
}  // namespace lefort::fem
