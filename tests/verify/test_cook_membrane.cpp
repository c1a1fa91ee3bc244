#include <lefort/verify/cook_membrane.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace lefort::verify {
namespace {

using fem::Dilatation;
using mesh::ElementShape;

/// How far the tip rises, as a share of the reference.
double rise(ElementShape shape, int cells, Dilatation dilatation = Dilatation::kAveraged) {
  const auto tip =
      solve_cook_membrane(make_cook_membrane(shape, cells), cook_material(), dilatation);
  EXPECT_TRUE(tip.has_value()) << tip.error().message;
  return tip ? tip->y() / kCookTipRise_mm : 0.0;
}

/// What is known of one shape.
struct Expected {
  ElementShape shape;
  int cells;               ///< Of the finer mesh; quadratic elements have nodes between.
  double error;            ///< Of the rise, at most.
  double error_pointwise;  ///< Without remedy, at least.
};

class CookMembranes : public testing::TestWithParam<Expected> {};
INSTANTIATE_TEST_SUITE_P(Shapes, CookMembranes,
                         testing::Values(Expected{ElementShape::kTet4, 16, 0.02, 0.4},
                                         Expected{ElementShape::kPyramid5, 16, 0.045, 0.6},
                                         Expected{ElementShape::kWedge6, 16, 0.035, 0.4},
                                         Expected{ElementShape::kHex8, 16, 0.02, 0.6},
                                         Expected{ElementShape::kTet10, 8, 0.02, 0.015},
                                         Expected{ElementShape::kWedge15, 8, 0.025, 0.05},
                                         Expected{ElementShape::kHex20, 8, 0.02, 0.06}),
                         [](const auto& shape) {
                           return std::string(mesh::name_of(shape.param.shape));
                         });

TEST_P(CookMembranes, TheTipComesToItsPlaceAndWithoutTheRemedyStaysBehind) {
  const auto& [shape, cells, error, error_pointwise] = GetParam();
  const double coarse = rise(shape, cells / 2);
  const double fine = rise(shape, cells);
  EXPECT_LT(std::abs(fine - 1.0), error);
  EXPECT_LT(std::abs(fine - 1.0), 0.5 * std::abs(coarse - 1.0));
  // The corner at the clamp leaves an order of about 1.5, whatever the element.
  const double limit = fine + (fine - coarse) / (std::pow(2.0, 1.5) - 1.0);
  EXPECT_NEAR(limit, 1.0, 0.01);
  EXPECT_GT(1.0 - rise(shape, cells, Dilatation::kPointwise), error_pointwise);
}

TEST(CookMembrane, BearsAHundredNewtonsPerMillimetreOfThickness) {
  const CookMembrane membrane = make_cook_membrane(ElementShape::kTet10, 4);
  Vec3 sum = Vec3::Zero();
  for (const fem::NodalForce& force : membrane.forces) sum += force.force_n;
  EXPECT_LT((sum - Vec3(0, 100.0 * 12.0, 0)).norm(), 1e-10);
  const Vec3& tip = membrane.mesh.nodes_L[std::size_t(membrane.tip)];
  EXPECT_EQ(tip.head<2>(), Eigen::Vector2d(48, 60));
}

}  // namespace
}  // namespace lefort::verify
