#include <lefort/predict/face_lips.h>
#include <lefort/predict/lip_contact.h>
#include <lefort/predict/oral_fissure.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

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

/// Energy, residual and stiffness of a node and a triangle.
struct PointEquations {
  double energy_mj = 0.0;
  VectorX r = VectorX::Zero(12);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(12, 12);
};

using Positions = std::array<Vec3, 4>;

PointEquations equations_of(const predict::LipContact& contact, const Positions& x) {
  PointEquations at;
  fem::LocalEquations local{.energy_mj = 0.0,
                            .residual_n = Eigen::Map<VectorX>(at.r.data(), 12),
                            .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(at.K.data(), 12, 12)};
  EXPECT_TRUE(contact.evaluate(0, x, local));
  at.energy_mj = local.energy_mj;
  return at;
}

constexpr double kArea_mm2 = 2.0, kStiffness = 0.3, kTone_mpa = 0.06, kRest_mm = 0.05;
const Vec3 kNormal_L = Vec3(0.2, -0.3, 0.9).normalized();

predict::LipContact one_point(double tone_mpa) {
  return {{{.nodes = {3, 5, 7, 8},
            .weights = {0.5, 0.3, 0.2},
            .normal_L = kNormal_L,
            .rest_mm = kRest_mm,
            .area_mm2 = kArea_mm2}},
          kStiffness,
          tone_mpa};
}

/// Positions with an opening.
Positions opened(double e_mm) {
  const Vec3 a(0.1, 0.2, -0.4), b(3.0, 0.1, 0.2), c(0.3, 2.0, 0.7);
  const Vec3 faced = 0.5 * a + 0.3 * b + 0.2 * c;
  const Vec3 beside = kNormal_L.cross(Vec3::UnitX());
  return {faced + (e_mm + kRest_mm) * kNormal_L + 0.4 * beside, a, b, c};
}

void expect_gradient(const predict::LipContact& contact, const Positions& x) {
  const PointEquations at = equations_of(contact, x);
  Vec3 sum = Vec3::Zero();
  for (Index i = 0; i < 4; ++i) sum += at.r.segment<3>(3 * i);
  EXPECT_NEAR(sum.norm(), 0.0, 1e-15);                              // Action and reaction.
  EXPECT_NEAR(at.r.head<3>().cross(kNormal_L).norm(), 0.0, 1e-15);  // No friction.
  constexpr double h = 1e-6;
  for (int i = 0; i < 12; ++i) {
    Positions up = x, down = x;
    up[std::size_t(i / 3)][i % 3] += h;
    down[std::size_t(i / 3)][i % 3] -= h;
    const PointEquations above = equations_of(contact, up), below = equations_of(contact, down);
    EXPECT_NEAR((above.energy_mj - below.energy_mj) / (2.0 * h), at.r[i], 1e-8);
    EXPECT_NEAR(((above.r - below.r) / (2.0 * h) - at.K.col(i)).norm(), 0.0, 1e-8);
  }
}

TEST(LipContact, pushes_along_the_normal_only_and_is_the_gradient_of_its_energy) {
  const predict::LipContact contact = one_point(0.0);
  EXPECT_EQ(contact.nodes(0)[0], 3);
  EXPECT_NEAR(equations_of(contact, opened(-0.4)).energy_mj, 0.5 * kArea_mm2 * kStiffness * 0.16,
              1e-15);
  expect_gradient(contact, opened(-0.4));
  EXPECT_EQ(equations_of(contact, opened(0.1)).energy_mj, 0.0);
}

TEST(LipContact, tone_closes_open_lips_with_a_constant_traction) {
  const predict::LipContact contact = one_point(kTone_mpa);
  for (const double opening_mm : {0.1, 0.19, 0.21, 1.0, 5.0}) {  // e_0 is 0.2 mm.
    expect_gradient(contact, opened(opening_mm));
    const double force_n = equations_of(contact, opened(opening_mm)).r.head<3>().dot(kNormal_L);
    EXPECT_NEAR(force_n, kArea_mm2 * std::min(kTone_mpa, kStiffness * opening_mm), 1e-14);
  }
  EXPECT_NEAR(equations_of(contact, opened(0.0)).r.norm(), 0.0, 1e-15);  // At rest.
}

TEST(LipContact, replaces_points_of_the_same_nodes_only) {
  predict::LipContact contact = one_point(0.0);
  predict::FacingPoint point{.nodes = {3, 5, 7, 8}, .normal_L = Vec3::UnitX(), .area_mm2 = 4.0};
  EXPECT_TRUE(contact.replace({point}));
  EXPECT_NEAR(
      equations_of(contact, {Vec3(-1.0, 0.0, 0.0), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()})
          .energy_mj,
      0.5 * 4.0 * kStiffness, 1e-15);
  point.nodes[2] = 9;
  EXPECT_FALSE(contact.replace({point}));
  EXPECT_FALSE(contact.replace({}));
}

/// Two lips that touch on z = 0, each a grid of 21 by 11 nodes, 1 mm apart. Nodes of odd numbers in
/// y are `serration_mm` above or below it.
struct TwoLips {
  mesh::VolumeMesh tissue;
  predict::LipSlit lips;

  explicit TwoLips(double serration_mm = 0.0) {
    predict::OralFissure& fissure = lips.fissure.emplace();
    fissure.first_x_mm = -40.0;
    fissure.columns.assign(81, {.skin_y_mm = -40.0, .jaw_y_mm = 40.0});
    fissure.right_x_mm = -40.0;
    fissure.left_x_mm = 40.0;
    for (int lip = 0; lip < 2; ++lip)
      for (int j = 0; j < kRows; ++j)
        for (int i = 0; i < kColumns; ++i)
          tissue.nodes_L.push_back(
              {i - 10.0, j - 5.0, j % 2 == 1 ? (i % 2 == 1 ? 1 : -1) * serration_mm : 0.0});
    for (int j = 0; j + 1 < kRows; ++j)
      for (int i = 0; i + 1 < kColumns; ++i) add_square(j * kColumns + i);
    for (int n = 0; n < kCount; ++n) lips.pairs.push_back({n, kCount + n, 1.0, Vec3::UnitZ()});
  }

  std::vector<predict::FacingPoint> face(const std::vector<Vec3>& x_L) const {
    return predict::face_lips(predict::lip_surfaces(tissue, lips), lips.pairs, x_L);
  }

  static constexpr int kColumns = 21, kRows = 11, kCount = kColumns * kRows;

 private:
  void add_square(int n) {
    for (const auto& [a, b, c] :
         {std::array{n, n + 1, n + kColumns + 1}, std::array{n, n + kColumns + 1, n + kColumns}}) {
      tissue.face_sets[predict::sets::kUpperLip].push_back({mesh::FaceShape::kTri3, {a, c, b}});
      tissue.face_sets[predict::sets::kLowerLip].push_back(
          {mesh::FaceShape::kTri3, {kCount + a, kCount + b, kCount + c}});
    }
  }
};

double opening_of(const predict::FacingPoint& point, const std::vector<Vec3>& x_L) {
  Positions x;
  for (std::size_t i = 0; i < 4; ++i) x[i] = x_L[std::size_t(point.nodes[i])];
  return predict::opening_mm(point, x);
}

TEST(FaceLips, at_rest_each_node_faces_the_other_of_its_pair) {
  const TwoLips two(0.2);
  const auto points = two.face(two.tissue.nodes_L);
  ASSERT_EQ(points.size(), 2 * two.lips.pairs.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    const predict::LipPair& pair = two.lips.pairs[p / 2];
    const bool is_upper = p % 2 == 0;
    EXPECT_EQ(points[p].nodes[0], is_upper ? pair.upper : pair.lower);
    const auto faced = std::size_t(points[p].weights.maxCoeff() == points[p].weights[0]   ? 1
                                   : points[p].weights.maxCoeff() == points[p].weights[1] ? 2
                                                                                          : 3);
    EXPECT_EQ(points[p].nodes[faced], is_upper ? pair.lower : pair.upper);
    EXPECT_NEAR(opening_of(points[p], two.tissue.nodes_L), 0.0, 1e-12);
    EXPECT_GT(points[p].normal_L.z() * (is_upper ? 1.0 : -1.0), 0.9);
    EXPECT_EQ(points[p].area_mm2, 0.5);
  }
}

/// In a coarse mesh a node of one lip can be a corner of a face of the other.
TEST(FaceLips, a_node_of_both_lips_faces_nothing) {
  TwoLips two;
  const auto count = two.face(two.tissue.nodes_L).size();
  for (mesh::Face& face : two.tissue.face_sets.at(predict::sets::kLowerLip))
    for (std::size_t c = 0; c < 3; ++c)
      if (face.nodes[c] == TwoLips::kCount + 30) face.nodes[c] = 30;
  two.lips.pairs.erase(two.lips.pairs.begin() + 30);
  two.lips.pairs.push_back({30, TwoLips::kCount + 29, 1.0, Vec3::UnitZ()});
  const auto points = two.face(two.tissue.nodes_L);
  EXPECT_LT(points.size(), count);
  for (const predict::FacingPoint& point : points)
    for (std::size_t i = 1; i < 4; ++i) EXPECT_NE(point.nodes[0], point.nodes[i]);
}

/// On a cylinder of radius 30 mm the lips stay closed; with the normals at rest the pairs of nodes
/// would overlap by 30 (1 - cos(s / 30)) mm.
TEST(FaceLips, slip_on_a_curved_surface_neither_opens_nor_overlaps) {
  for (const double serration_mm : {0.0, 0.2}) {
    const TwoLips two(serration_mm);
    constexpr double kRadius_mm = 30.0, kSlip_mm = 4.0;
    std::vector<Vec3> x_L = two.tissue.nodes_L;
    for (std::size_t n = 0; n < x_L.size(); ++n) {
      const bool is_lower = n >= std::size_t(TwoLips::kCount);
      const double angle = (x_L[n].x() + (is_lower ? kSlip_mm : 0.0)) / kRadius_mm;
      const double r = kRadius_mm + x_L[n].z();
      x_L[n] = {r * std::sin(angle), x_L[n].y(), r * std::cos(angle)};
    }
    const auto points = two.face(x_L);
    // Nodes beyond the ends of the other lip face nothing: 4 of 21 columns.
    EXPECT_EQ(points.size(), std::size_t(2 * (TwoLips::kColumns - 4) * TwoLips::kRows));
    for (const predict::FacingPoint& point : points)
      EXPECT_NEAR(opening_of(point, x_L), 0.0, 0.02) << serration_mm;
  }
}

TEST(FaceLips, open_and_overlapping_lips_have_their_distance) {
  const TwoLips two;
  for (const double opening_mm : {2.0, 0.3, -0.3}) {
    std::vector<Vec3> x_L = two.tissue.nodes_L;
    for (int n = 0; n < TwoLips::kCount; ++n) x_L[std::size_t(n)] += Vec3(0.3, 0.2, opening_mm);
    for (const predict::FacingPoint& point : two.face(x_L)) {
      EXPECT_NEAR(opening_of(point, x_L), opening_mm, 1e-12);
      EXPECT_NEAR(point.weights.sum(), 1.0, 1e-12);
    }
  }
}

TEST(LipStatistics, measure_overlap_opening_and_slip) {
  const TwoLips two;
  std::vector<Vec3> u(two.tissue.nodes_L.size(), Vec3::Zero());
  for (int n = 0; n < TwoLips::kCount; ++n) {
    const double x = two.tissue.nodes_L[std::size_t(n)].x();
    u[std::size_t(n)] = {0.0, 1.0, x < -5.5 ? -0.2 : x > 5.5 ? 1.5 : 0.0};
  }
  const predict::LipStatistics statistics = predict::lip_statistics(two.tissue, two.lips, u);
  EXPECT_NEAR(statistics.max_overlap_mm, 0.2, 1e-3);
  EXPECT_NEAR(statistics.max_opening_mm, 1.5, 1e-3);
  EXPECT_NEAR(statistics.max_slip_mm, 1.0, 1e-12);
  EXPECT_GT(statistics.closed_fraction, 0.6);
  EXPECT_LT(statistics.closed_fraction, 0.75);
}

}  // namespace
}  // namespace lefort::test
