#include <lefort/solve/load_curve.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::solve::test_load_curve {
namespace {

TEST(LoadCurve, IsARampByDefault) {
  const LoadCurve curve;
  for (const double t : {0.0, 0.25, 1.0}) EXPECT_EQ(factor_at(curve, t), t);
}

TEST(LoadCurve, IsLinearBetweenPointsAndConstantOutside) {
  const LoadCurve curve{{{0.2, 1.0}, {0.6, 3.0}, {0.7, -1.0}}};
  EXPECT_EQ(factor_at(curve, 0.0), 1.0);
  EXPECT_EQ(factor_at(curve, 0.2), 1.0);
  EXPECT_NEAR(factor_at(curve, 0.3), 1.5, 1e-15);
  EXPECT_EQ(factor_at(curve, 0.6),
            3.0);  // Exact, so that a factor of 0 removes the load completely.
  EXPECT_NEAR(factor_at(curve, 0.65), 1.0, 1e-14);
  EXPECT_EQ(factor_at(curve, 1.0), -1.0);
}

TEST(LoadCurve, RejectsTimesThatDoNotAscendOrLieOutside) {
  const auto refusal = [](std::vector<CurvePoint> points) {
    const auto checked = check_curve({std::move(points)});
    return checked ? std::string() : checked.error().message;
  };
  EXPECT_EQ(refusal({{0.0, 0.0}, {1.0, 2.0}}), "");
  EXPECT_NE(refusal({}).find("no point"), std::string::npos);
  EXPECT_NE(refusal({{0.5, 0.0}, {0.5, 1.0}}).find("ascend"), std::string::npos);
  EXPECT_NE(refusal({{0.0, 0.0}, {1.5, 1.0}}).find("1.5"), std::string::npos);
  EXPECT_NE(refusal({{std::nan(""), 0.0}}).find("nan"), std::string::npos);
  EXPECT_NE(refusal({{0.0, INFINITY}}).find("finite"), std::string::npos);
}

}  // namespace
}  // namespace lefort::solve::test_load_curve
