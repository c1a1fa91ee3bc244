#include <lefort/predict/lip_contact.h>
#include <lefort/predict/oral_fissure.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lefort::test {
namespace {

using anatomy::Tissue;
using predict::FissureSource;

/// Jaws as boxes: upper above z = 0, mandible below z = -2, anterior surface at y = 0.
anatomy::LabelMap jaws() {
  anatomy::LabelMap labels;
  labels.grid.size = {81, 81, 81};
  labels.grid.origin_L = {-40.0, -30.0, -40.0};
  for (Index k = 0; k < 81; ++k)
    for (Index j = 0; j < 81; ++j)
      for (Index i = 0; i < 81; ++i) {
        const Vec3 p = labels.grid.point_L({double(i), double(j), double(k)});
        const bool is_bone = std::abs(p.x()) <= 25.0 && p.y() >= 0.0 && p.y() <= 30.0;
        Tissue tissue = p.y() > -15.0 ? Tissue::kSoftTissue : Tissue::kBackground;
        if (is_bone && p.z() >= 0.0) tissue = Tissue::kBone;
        if (is_bone && p.z() <= -2.0 && p.z() > -30.0) tissue = Tissue::kMandible;
        labels.values.push_back(tissue);
      }
  return labels;
}

/// Soft tissue behind a skin at y = -12, with a crease of `depth` at height `z` between x = -24
/// and 22.
image::ScalarVolume skin(const image::Grid& grid, double z, double depth) {
  image::ScalarVolume level{grid, {}};
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const Vec3 p = grid.point_L({double(i), double(j), double(k)});
        const bool is_mouth = p.x() > -24.0 && p.x() < 22.0;
        const double crease =
            is_mouth ? depth * std::max(0.0, 1.0 - std::abs(p.z() - z) / 3.0) : 0.0;
        level.values.push_back(float(p.y() + 12.0 - crease));
      }
  return level;
}

TEST(OralFissure, follows_the_crease_of_the_skin_from_commissure_to_commissure) {
  const anatomy::LabelMap labels = jaws();
  const auto search = predict::find_oral_fissure(labels, skin(labels.grid, 3.0, 2.0), {});
  ASSERT_TRUE(search.fissure) << search.reason;
  const predict::OralFissure& fissure = *search.fissure;
  EXPECT_EQ(fissure.source, FissureSource::kCrease);
  EXPECT_NEAR(fissure.crease_depth_mm, 2.0, 0.3);
  EXPECT_NEAR(fissure.right_x_mm, -24.0, 2.0);
  EXPECT_NEAR(fissure.left_x_mm, 22.0, 2.0);
  EXPECT_GT(fissure.confidence, 0.9);
  // At the skin the height of the crease, at the teeth that of their edges.
  EXPECT_NEAR(fissure.level({0.0, -12.0, 3.0}), 0.0, 0.5);
  EXPECT_NEAR(fissure.level({0.0, 0.0, fissure.edge_z_mm}), 0.0, 0.1);
  EXPECT_NEAR(fissure.edge_z_mm, -1.0, 1.0);
  EXPECT_GT(fissure.level({0.0, -5.0, 8.0}), 0.0);
  EXPECT_LT(fissure.level({0.0, -5.0, -8.0}), 0.0);
  EXPECT_GT(fissure.extent({0.0, 4.0, 0.0}), 0.0);
  EXPECT_LT(fissure.extent({0.0, 9.0, 0.0}), 0.0);
  EXPECT_LT(fissure.extent({30.0, 0.0, 0.0}), 0.0);
}

TEST(OralFissure, without_a_crease_lies_between_the_jaws_without_confidence) {
  const anatomy::LabelMap labels = jaws();
  const auto search = predict::find_oral_fissure(labels, skin(labels.grid, 3.0, 0.0), {});
  ASSERT_TRUE(search.fissure);
  EXPECT_EQ(search.fissure->source, FissureSource::kJaws);
  EXPECT_EQ(search.fissure->confidence, 0.0);
  EXPECT_NEAR(search.fissure->width_mm(), 52.0, 1e-9);
  EXPECT_NEAR(search.fissure->level({5.0, -12.0, -1.0}), 0.0, 1e-6);
}

TEST(OralFissure, landmarks_override_what_is_found) {
  const anatomy::LabelMap labels = jaws();
  const predict::LipLandmarks landmarks{Vec3(1.0, -12.0, 9.0), Vec3(-22.0, -12.0, 8.0),
                                        Vec3(27.0, -12.0, 8.0)};
  const auto search = predict::find_oral_fissure(labels, skin(labels.grid, -6.0, 2.0), landmarks);
  ASSERT_TRUE(search.fissure);
  EXPECT_EQ(search.fissure->source, FissureSource::kLandmarks);
  EXPECT_EQ(search.fissure->confidence, 1.0);
  EXPECT_EQ(search.fissure->right_x_mm, -22.0);
  EXPECT_EQ(search.fissure->left_x_mm, 27.0);
  EXPECT_NEAR(search.fissure->level({1.0, -12.0, 9.0}), 0.0, 3.0);
  EXPECT_LT(search.fissure->level({1.0, -12.0, 3.0}), 0.0);
}

TEST(OralFissure, needs_a_mandible_or_stomion) {
  anatomy::LabelMap labels = jaws();
  std::replace(labels.values.begin(), labels.values.end(), Tissue::kMandible, Tissue::kBone);
  const image::ScalarVolume soft = skin(labels.grid, 3.0, 2.0);
  const auto none = predict::find_oral_fissure(labels, soft, {});
  EXPECT_FALSE(none.fissure);
  EXPECT_NE(none.reason.find("mandible"), std::string::npos);
  EXPECT_TRUE(predict::find_oral_fissure(labels, soft, {Vec3(0.0, -12.0, 3.0), {}, {}}).fissure);
}

/// Energy, residual and stiffness of a pair.
struct PairEquations {
  double energy_mj = 0.0;
  VectorX r = VectorX::Zero(6);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(6, 6);
};

PairEquations equations_of(const predict::LipContact& contact, const std::array<Vec3, 2>& x) {
  PairEquations at;
  fem::LocalEquations local{.energy_mj = 0.0,
                            .residual_n = Eigen::Map<VectorX>(at.r.data(), 6),
                            .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(at.K.data(), 6, 6)};
  EXPECT_TRUE(contact.evaluate(0, x, local));
  at.energy_mj = local.energy_mj;
  return at;
}

constexpr double kArea_mm2 = 2.0, kStiffness = 0.3, kTone_mpa = 0.06;
const Vec3 kNormal_L = Vec3(0.2, -0.3, 0.9).normalized();

predict::LipContact one_pair(double tone_mpa) {
  return {{{.upper = 3, .lower = 5, .area_mm2 = kArea_mm2, .normal_L = kNormal_L}},
          kStiffness,
          tone_mpa};
}

void expect_gradient(const predict::LipContact& contact, const std::array<Vec3, 2>& x) {
  const PairEquations at = equations_of(contact, x);
  EXPECT_NEAR((at.r.head<3>() + at.r.tail<3>()).norm(), 0.0, 1e-15);  // Action and reaction.
  EXPECT_NEAR(at.r.head<3>().cross(kNormal_L).norm(), 0.0, 1e-15);    // No friction.
  constexpr double h = 1e-6;
  for (int i = 0; i < 6; ++i) {
    std::array<Vec3, 2> up = x, down = x;
    up[std::size_t(i / 3)][i % 3] += h;
    down[std::size_t(i / 3)][i % 3] -= h;
    const PairEquations above = equations_of(contact, up), below = equations_of(contact, down);
    EXPECT_NEAR((above.energy_mj - below.energy_mj) / (2.0 * h), at.r[i], 1e-8);
    EXPECT_NEAR(((above.r - below.r) / (2.0 * h) - at.K.col(i)).norm(), 0.0, 1e-8);
  }
}

TEST(LipContact, pushes_along_the_normal_only_and_is_the_gradient_of_its_energy) {
  const predict::LipContact contact = one_pair(0.0);
  EXPECT_EQ(contact.nodes(0)[0], 3);
  const std::array<Vec3, 2> overlapping{Vec3(0.1, 0.0, -0.4), Vec3(0.0, 0.2, 0.1)};
  const double e = kNormal_L.dot(overlapping[0] - overlapping[1]);
  EXPECT_NEAR(equations_of(contact, overlapping).energy_mj, 0.5 * kArea_mm2 * kStiffness * e * e,
              1e-15);
  expect_gradient(contact, overlapping);
  EXPECT_EQ(equations_of(contact, {overlapping[1], overlapping[0]}).energy_mj, 0.0);  // Open.
}

TEST(LipContact, tone_closes_open_lips_with_a_constant_traction) {
  const predict::LipContact contact = one_pair(kTone_mpa);
  for (const double opening_mm : {0.1, 0.19, 0.21, 1.0, 5.0}) {  // e_0 is 0.2 mm.
    const std::array<Vec3, 2> open{opening_mm * kNormal_L, Vec3::Zero()};
    expect_gradient(contact, open);
    const double force_n = equations_of(contact, open).r.head<3>().dot(kNormal_L);
    EXPECT_NEAR(force_n, kArea_mm2 * std::min(kTone_mpa, kStiffness * opening_mm), 1e-15);
  }
  EXPECT_EQ(equations_of(contact, {Vec3::Zero(), Vec3::Zero()}).r.norm(), 0.0);  // At rest.
}

TEST(LipStatistics, measure_overlap_opening_and_slip) {
  predict::LipSlit lips;
  lips.pairs = {{0, 1, 1.0, Vec3::UnitZ()}, {2, 3, 3.0, Vec3::UnitZ()}};
  const std::vector<Vec3> u{{0, 0, 0}, {3, 4, 0.2}, {0, 0, 1.5}, {0, 0, 0}};
  const predict::LipStatistics statistics = predict::lip_statistics(lips, u);
  EXPECT_NEAR(statistics.max_overlap_mm, 0.2, 1e-15);
  EXPECT_NEAR(statistics.max_opening_mm, 1.5, 1e-15);
  EXPECT_NEAR(statistics.max_slip_mm, 5.0, 1e-15);
  EXPECT_NEAR(statistics.closed_fraction, 0.25, 1e-15);
}

}  // namespace
}  // namespace lefort::test
