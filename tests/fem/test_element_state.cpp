#include <lefort/fem/assembly/element_state.h>

#include <gtest/gtest.h>

#include "fem/body.h"
#include "support/box_mesh.h"

namespace lefort::fem::test_element_state {
namespace {

constexpr NeoHookean kSoft{.mu_mpa = 0.5, .lambda_mpa = 2.0};
constexpr NeoHookean kStiff{.mu_mpa = 3.0, .lambda_mpa = 2.0};

class ElementStates : public testing::TestWithParam<mesh::ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, ElementStates, testing::ValuesIn(test::kAllElements),
                         test::shape_name);

TEST_P(ElementStates, AreThoseOfTheUniformDeformation) {
  auto mesh = test::box_mesh({.cells = {2, 2, 2}, .distortion = 0.1, .shape = GetParam()});
  mesh.blocks[0].region[7] = 4;
  Mat3 F;
  F << 1.2, 0.1, 0.0, -0.2, 0.9, 0.3, 0.0, 0.1, 1.1;
  const auto states = element_states(mesh, {{0, kSoft}, {4, kStiff}},
                                     test::affine(mesh, F - Mat3::Identity(), Vec3(5, 6, 7)));
  ASSERT_EQ(Index(states.size()), mesh.element_count());
  for (std::size_t e = 0; e < states.size(); ++e) {
    const NeoHookean& law = e == 7 ? kStiff : kSoft;
    EXPECT_NEAR(states[e].min_volume_ratio, F.determinant(), 1e-13);
    EXPECT_LT((states[e].cauchy_mpa - cauchy_stress(law.stress(F), F)).norm(), 1e-12);
    EXPECT_NEAR(states[e].energy_density_mpa, law.energy(F), 1e-13);
  }
}

TEST_P(ElementStates, StretchesDoNotChangeUnderARotation) {
  const auto mesh = test::box_mesh({.cells = {1, 1, 1}, .shape = GetParam()});
  const Mat3 F = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix() *
                 Vec3(0.9, 1.4, 1.1).asDiagonal();
  for (const ElementState& state :
       element_states(mesh, {{0, kSoft}}, test::affine(mesh, F - Mat3::Identity(), Vec3::Zero())))
    EXPECT_LT((state.stretches - Vec3(1.4, 1.1, 0.9)).norm(), 1e-12);
}

TEST_P(ElementStates, AnInvertedElementIsReported) {
  const auto mesh = test::box_mesh({.cells = {1, 1, 1}, .shape = GetParam()});
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  const auto states = element_states(mesh, {{0, kSoft}},
                                     test::affine(mesh, mirror - Mat3::Identity(), Vec3::Zero()));
  EXPECT_NEAR(states[0].min_volume_ratio, -1.0, 1e-13);
  EXPECT_TRUE(std::isnan(states[0].energy_density_mpa));
}

}  // namespace
}  // namespace lefort::fem::test_element_state
