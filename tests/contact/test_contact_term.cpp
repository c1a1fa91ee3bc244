#include <lefort/contact/bone_passage.h>
#include <lefort/contact/contact_term.h>
#include <lefort/core/check.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/mesh/element_faces.h>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace lefort::contact::test_contact_term {
namespace {

constexpr double kStiffness = 0.04;

constexpr double kHardening = 0.05;

ContactTerm::Options options(double contact_snap_mm, double hardening_mpa_per_mm2 = 0.0) {
  return {.name = "the plate",
          .law = {kStiffness, hardening_mpa_per_mm2, 0.8},
          .contact_snap_mm = contact_snap_mm};
}

/// A slab of bone with its upper face at z = 0.
RigidObstacle slab() {
  static const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(test::make_box({-10.0, -10.0, -8.0}, {10.0, 10.0, 0.0}),
                                  {.resolution = 64, .band_mm = 3.0, .smooth = true})
          .value());
  return {field_distance_query(field, DetectionMethod::kSmooth).value()};
}

RigidObstacle ball(DetectionMethod detection = DetectionMethod::kSmooth) {
  static const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(test::make_icosphere(6.0, 5),
                                  {.resolution = 64, .band_mm = 2.0, .smooth = true})
          .value());
  return {field_distance_query(field, detection).value()};
}

/// A plate, 2 mm thick, with its upper face at z = 0.
RigidObstacle plate() {
  static const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(test::make_box({-10.0, -10.0, -2.0}, {10.0, 10.0, 0.0}),
                                  {.resolution = 64, .band_mm = 3.0, .smooth = true})
          .value());
  return {field_distance_query(field, DetectionMethod::kSmooth).value()};
}

/// The lower face of the tissue above the slab, at height z; its normal points down.
std::vector<Vec3> flat_face(double z) { return {{0.0, 0.0, z}, {0.0, 4.0, z}, {4.0, 0.0, z}}; }
const std::vector<mesh::Face> kFace{{mesh::FaceShape::kTri3, {0, 1, 2}}};
constexpr double kFaceArea_mm2 = 8.0;

RigidTransform lifted(double by_mm) {
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.translation().z() = by_mm;
  return X_LB;
}

struct Evaluated {
  bool admissible;
  double energy_mj;
  VectorX residual_n;
  Eigen::MatrixXd stiffness;
  Index contacts = 0;
};

Evaluated evaluate(const ContactTerm& term, Index item, const std::vector<Vec3>& x_L,
                   fem::Tangent tangent = fem::Tangent::kExact) {
  const auto size = Index(3 * x_L.size());
  Evaluated result{false, 0.0, VectorX::Zero(size), Eigen::MatrixXd::Zero(size, size)};
  fem::LocalEquations local{
      0.0, {result.residual_n.data(), size}, {result.stiffness.data(), size, size}, tangent};
  result.admissible = term.evaluate(item, x_L, local);
  result.energy_mj = local.energy_mj;
  result.contacts = local.contacts;
  return result;
}

/// Compares residual and stiffness with central differences of energy and residual.
/// \param equations  function of the nodal positions.
void expect_derivatives_of_energy(
    const std::function<Evaluated(const std::vector<Vec3>& x_L)>& equations,
    const std::vector<Vec3>& x_L) {
  constexpr double kStep = 1e-6;
  const Evaluated at = equations(x_L);
  for (Index dof = 0; dof < Index(3 * x_L.size()); ++dof) {
    std::vector<Vec3> plus = x_L, minus = x_L;
    plus[std::size_t(dof / 3)][dof % 3] += kStep;
    minus[std::size_t(dof / 3)][dof % 3] -= kStep;
    const Evaluated above = equations(plus), below = equations(minus);
    EXPECT_NEAR(at.residual_n[dof], (above.energy_mj - below.energy_mj) / (2.0 * kStep), 1e-8);
    EXPECT_LT((at.stiffness.col(dof) - (above.residual_n - below.residual_n) / (2.0 * kStep))
                  .cwiseAbs()
                  .maxCoeff(),
              3e-6);
  }
}

TEST(ContactTerm, ForceOnAFlatFaceIsTwiceStiffnessDepthArea) {
  ContactTerm term(flat_face(0.0), kFace, slab(), options(0.5));
  term.set_pose(lifted(1.5));
  const Evaluated at_rest = evaluate(term, 0, flat_face(0.0));
  ASSERT_TRUE(at_rest.admissible);
  EXPECT_NEAR(at_rest.energy_mj, kStiffness * 1.5 * 1.5 * kFaceArea_mm2, 1e-6);
  double up_n = 0.0;
  for (int corner = 0; corner < 3; ++corner) up_n -= at_rest.residual_n[3 * corner + 2];
  EXPECT_NEAR(up_n, 2.0 * kStiffness * 1.5 * kFaceArea_mm2, 1e-6);
}

TEST(ContactTerm, IsFrictionless) {
  ContactTerm term(flat_face(0.0), kFace, slab(), options(0.5));
  term.set_pose(lifted(1.0));
  const Evaluated pressed = evaluate(term, 0, flat_face(0.0));
  for (int corner = 0; corner < 3; ++corner) {
    EXPECT_NEAR(pressed.residual_n[3 * corner], 0.0, 1e-9);
    EXPECT_NEAR(pressed.residual_n[3 * corner + 1], 0.0, 1e-9);
  }
}

TEST(ContactTerm, TissueAtRestIsFreeOfForceAtAnyRestGap) {
  for (const double z : {-0.4, -0.1, 0.0, 0.3}) {
    const ContactTerm term(flat_face(z), kFace, slab(), options(0.5));
    const Evaluated at_rest = evaluate(term, 0, flat_face(z));
    EXPECT_EQ(at_rest.energy_mj, 0.0) << "rest at z = " << z;
  }
}

TEST(ContactTerm, TissueBeyondTheContactToleranceIsFreeUntilTheBoneReachesIt) {
  ContactTerm term(flat_face(1.0), kFace, slab(), options(0.5));
  term.set_pose(lifted(0.9));
  EXPECT_EQ(evaluate(term, 0, flat_face(1.0)).energy_mj, 0.0);
  term.set_pose(lifted(1.5));
  EXPECT_NEAR(evaluate(term, 0, flat_face(1.0)).energy_mj, kStiffness * 0.25 * kFaceArea_mm2, 1e-6);
}

TEST(ContactTerm, TissueFromBeyondTheBandComesIntoContact) {
  const auto energy_mj = [](double rest_z, double lift_mm, double z) {
    ContactTerm term(flat_face(rest_z), kFace, slab(), options(0.5));
    term.set_pose(lifted(lift_mm));
    return evaluate(term, 0, flat_face(z)).energy_mj;
  };
  const double one_deep_mj = kStiffness * kFaceArea_mm2;
  EXPECT_NEAR(energy_mj(6.0, 7.0, 6.0), one_deep_mj, 1e-6);   // The bone came,
  EXPECT_NEAR(energy_mj(6.0, 0.0, -1.0), one_deep_mj, 1e-6);  // or the tissue,
  EXPECT_NEAR(energy_mj(6.0, 3.0, 2.0), one_deep_mj, 1e-6);   // or both.
  EXPECT_EQ(energy_mj(6.0, 5.9, 6.0), 0.0);
  EXPECT_NEAR(energy_mj(1.0, 0.0, -1.0), one_deep_mj, 1e-6);
}

TEST(ContactTerm, ARetreatingBoneDoesNotPull) {
  ContactTerm term(flat_face(0.0), kFace, slab(), options(0.5));
  term.set_pose(lifted(-1.0));
  EXPECT_EQ(evaluate(term, 0, flat_face(0.0)).residual_n.norm(), 0.0);
}

TEST(ContactTerm, DeeperThanTheBandIsInadmissible) {
  ContactTerm term(flat_face(0.0), kFace, slab(), options(0.5));
  term.set_pose(lifted(3.9));
  EXPECT_FALSE(evaluate(term, 0, flat_face(0.0)).admissible);
}

TEST(ContactTerm, AContactToleranceBeyondTheBandIsALogicError) {
  EXPECT_THROW(ContactTerm(flat_face(0.0), kFace, slab(), options(3.0)), LogicError);
}

TEST(ContactTerm, PenetrationAndPenetrationIncreaseDiffer) {
  ContactTerm term(flat_face(-0.4), kFace, slab(), options(0.5));
  EXPECT_NEAR(term.rest_penetration_mm(), 0.4, 1e-6);
  term.set_pose(lifted(1.0));
  const ContactStatistics pressed = term.summarize(flat_face(-0.4));
  EXPECT_NEAR(pressed.max_penetration_mm, 1.4, 1e-6);
  EXPECT_NEAR(pressed.mean_penetration_mm, 1.4, 1e-6);
  EXPECT_NEAR(pressed.max_penetration_increase_mm, 1.0, 1e-6);
  EXPECT_NEAR(pressed.mean_penetration_increase_mm, 1.0, 1e-6);
}

struct Tested {
  DetectionMethod detection;
  double hardening_mpa_per_mm2;
};

class ContactTermOnABall : public testing::TestWithParam<Tested> {};
INSTANTIATE_TEST_SUITE_P(WithAPotential, ContactTermOnABall,
                         testing::Values(Tested{DetectionMethod::kTrilinear, 0.0},
                                         Tested{DetectionMethod::kSmooth, 0.0},
                                         Tested{DetectionMethod::kTrilinear, kHardening},
                                         Tested{DetectionMethod::kSmooth, kHardening}));

/// \returns the sum of the equations of all items.
Evaluated gather(const ContactTerm& term, const std::vector<Vec3>& x_L) {
  const auto size = Index(3 * x_L.size());
  Evaluated sum{true, 0.0, VectorX::Zero(size), Eigen::MatrixXd::Zero(size, size)};
  for (Index item = 0; item < term.item_count(); ++item) {
    std::vector<Vec3> local_L;
    for (const std::int32_t node : term.nodes(item)) local_L.push_back(x_L[std::size_t(node)]);
    const Evaluated one = evaluate(term, item, local_L);
    sum.admissible = sum.admissible && one.admissible;
    sum.energy_mj += one.energy_mj;
    const auto nodes = term.nodes(item);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      sum.residual_n.segment<3>(3 * nodes[a]) += one.residual_n.segment<3>(3 * Index(a));
      for (std::size_t b = 0; b < nodes.size(); ++b)
        sum.stiffness.block<3, 3>(3 * nodes[a], 3 * nodes[b]) +=
            one.stiffness.block<3, 3>(3 * Index(a), 3 * Index(b));
    }
  }
  return sum;
}

TEST_P(ContactTermOnABall, ResidualAndStiffnessAreTheDerivativesOfTheEnergy) {
  const std::vector<Vec3> rest{{6.2, -1.0, -1.0}, {6.2, 1.2, -0.8}, {6.2, 0.1, 1.3}};
  ContactTerm term(rest, kFace, ball(GetParam().detection),
                   options(0.1, GetParam().hardening_mpa_per_mm2));
  EXPECT_TRUE(term.is_conservative(fem::DofMap::build(3, {}).value()));
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.translation() = Vec3(0.9, 0.2, -0.1);
  term.set_pose(X_LB);
  ASSERT_GT(gather(term, rest).energy_mj, 0.0);
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> shift_mm(-0.15, 0.15);
  for (int state = 0; state < 5; ++state) {
    std::vector<Vec3> x_L = rest;
    for (Vec3& x : x_L) x += Vec3(shift_mm(generator), shift_mm(generator), shift_mm(generator));
    const Evaluated at = gather(term, x_L);
    ASSERT_GT(at.residual_n.norm(), 0.0);
    expect_derivatives_of_energy([&](const auto& x) { return gather(term, x); }, x_L);
    EXPECT_LT((at.stiffness - at.stiffness.transpose()).norm(), 1e-12);
  }
}

/// A slightly warped face of any shape near the ball; mid-edge nodes are off the straight edge.
std::vector<Vec3> warped_face(mesh::FaceShape shape) {
  std::vector<Vec3> x{{6.2, -1.0, -1.0}, {6.2, 1.2, -0.8}, {6.3, 1.1, 1.3}, {6.2, -0.9, 1.0}};
  const auto corners = std::size_t(mesh::corner_count(shape));
  x.resize(corners);
  const auto count = std::size_t(mesh::node_count(shape));
  for (std::size_t a = 0; x.size() < count; ++a)
    x.emplace_back(0.5 * (x[a] + x[(a + 1) % corners]) + Vec3(0.05, 0.0, 0.02));
  return x;
}

class ContactTermOnFaces : public testing::TestWithParam<mesh::FaceShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, ContactTermOnFaces,
                         testing::Values(mesh::FaceShape::kTri3, mesh::FaceShape::kQuad4,
                                         mesh::FaceShape::kTri6, mesh::FaceShape::kQuad8));

TEST_P(ContactTermOnFaces, ResidualAndStiffnessAreTheDerivativesOfTheEnergy) {
  const std::vector<Vec3> rest = warped_face(GetParam());
  ContactTerm term(rest, {{GetParam(), {0, 1, 2, 3, 4, 5, 6, 7}}}, ball(), options(0.1));
  ASSERT_EQ(term.nodes(0).size(), rest.size());
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.translation() = Vec3(0.9, 0.2, -0.1);
  term.set_pose(X_LB);
  ASSERT_GT(evaluate(term, 0, rest).energy_mj, 0.0);
  expect_derivatives_of_energy([&](const auto& x) { return evaluate(term, 0, x); }, rest);
}

TEST_P(ContactTermOnFaces, ForceOnAFlatFaceIsTwiceStiffnessDepthArea) {
  const auto corners = std::size_t(mesh::corner_count(GetParam()));
  std::vector<Vec3> x{{0, 0, 0}, {0, 4, 0}, {4, 4, 0}, {4, 0, 0}};
  if (corners == 3) x.erase(x.begin() + 2);
  for (std::size_t a = 0; x.size() < std::size_t(mesh::node_count(GetParam())); ++a)
    x.emplace_back(0.5 * (x[a] + x[(a + 1) % corners]));
  ContactTerm term(x, {{GetParam(), {0, 1, 2, 3, 4, 5, 6, 7}}}, slab(), options(0.5));
  term.set_pose(lifted(1.5));
  const double area_mm2 = corners == 3 ? 8.0 : 16.0;
  EXPECT_NEAR(evaluate(term, 0, x).energy_mj, kStiffness * 1.5 * 1.5 * area_mm2, 1e-6);
  EXPECT_NEAR(term.summarize(x).force_L_n.z(), 2.0 * kStiffness * 1.5 * area_mm2, 1e-6);
}

double min_eigenvalue(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues().minCoeff();
}

TEST(ContactTerm, TheStabilizedTangentOnAConvexBoneHasNoNegativeEigenvalue) {
  const std::vector<Vec3> rest{{6.2, -1.0, -1.0}, {6.2, 1.2, -0.8}, {6.2, 0.1, 1.3}};
  ContactTerm term(rest, kFace, ball(), options(0.1));
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.translation() = Vec3(0.9, 0.2, -0.1);
  term.set_pose(X_LB);
  const Evaluated exact = evaluate(term, 0, rest);
  const Evaluated convex = evaluate(term, 0, rest, fem::Tangent::kStabilized);
  EXPECT_LT(min_eigenvalue(exact.stiffness), -1e-4);
  EXPECT_GT(min_eigenvalue(convex.stiffness), -1e-12);
  EXPECT_EQ(convex.energy_mj, exact.energy_mj);
  EXPECT_EQ(convex.residual_n, exact.residual_n);
}

TEST(ContactTerm, StatisticsAreSumsOverThePoints) {
  const std::vector<Vec3> nodes{{0.0, 0.0, 0.0}, {0.0, 4.0, 0.0}, {4.0, 0.0, 0.0}, {4.0, 4.0, 0.0}};
  ContactTerm term(nodes,
                   {{mesh::FaceShape::kTri3, {0, 1, 2}}, {mesh::FaceShape::kTri3, {1, 3, 2}}},
                   slab(), options(0.5));
  EXPECT_EQ(term.summarize(nodes).points, 0);
  term.set_pose(lifted(1.0));
  const ContactStatistics pressed = term.summarize(nodes);
  EXPECT_EQ(pressed.points, 24);
  EXPECT_EQ(pressed.nodes, 4);
  EXPECT_NEAR(pressed.area_mm2, 16.0, 1e-9);
  EXPECT_NEAR(pressed.max_penetration_mm, 1.0, 1e-6);
  EXPECT_NEAR(pressed.mean_penetration_mm, 1.0, 1e-6);
  EXPECT_NEAR(pressed.mean_penetration_increase_mm, 1.0, 1e-6);
  EXPECT_NEAR(pressed.force_L_n.z(), 2.0 * kStiffness * 16.0, 1e-6);
  EXPECT_NEAR(pressed.normal_force_n, pressed.force_L_n.z(), 1e-9);
}

TEST(ContactTerm, ReportsPressureAndGapOfEveryNode) {
  const std::vector<Vec3> rest{{0, 0, 0}, {0, 4, 0}, {4, 0, 0}, {9, 9, 9}};
  ContactTerm term(rest, kFace, slab(), options(0.5));
  term.set_pose(lifted(1.0));
  const std::vector<NodalContact> flat = term.at_nodes(rest);
  ASSERT_EQ(flat.size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(flat[n].node, std::int32_t(n));
    EXPECT_NEAR(flat[n].pressure_mpa, 2.0 * kStiffness * 1.0, 1e-6);
    EXPECT_NEAR(flat[n].gap_mm, -1.0, 1e-6);
    EXPECT_NEAR(flat[n].depth_mm, 1.0, 1e-6);
  }
  std::vector<Vec3> tilted = rest;
  tilted[1].z() = 0.6;
  const std::vector<NodalContact> touched = term.at_nodes(tilted);
  EXPECT_NEAR(touched[1].gap_mm, -0.4, 1e-6);
  EXPECT_LT(touched[1].pressure_mpa, touched[0].pressure_mpa);
  EXPECT_NEAR(touched[0].pressure_mpa, touched[2].pressure_mpa, 1e-6);
  // A third of the face belongs to each of its corners.
  const double sum_mpa =
      touched[0].pressure_mpa + touched[1].pressure_mpa + touched[2].pressure_mpa;
  EXPECT_NEAR(sum_mpa * kFaceArea_mm2 / 3.0, term.summarize(tilted).normal_force_n, 1e-9);
  term.set_pose(lifted(-1.0));
  EXPECT_EQ(term.at_nodes(rest)[0].pressure_mpa, 0.0);
}

TEST(ContactTerm, RejectsAStateInWhichAPlateHasJumpedThrough) {
  ContactTerm term(flat_face(0.0), kFace, plate(), options(0.5));
  const RigidTransform at_rest = RigidTransform::Identity();
  term.set_pose(lifted(0.8));
  EXPECT_FALSE(term.rejection_reason(at_rest, flat_face(0.0), flat_face(0.0)));
  term.set_pose(lifted(1.5));  // The lower face is the closest one now.
  EXPECT_LT(term.summarize(flat_face(0.0)).force_L_n.z(), 0.0);
  const auto thin = term.rejection_reason(at_rest, flat_face(0.0), flat_face(0.0));
  ASSERT_TRUE(thin);
  EXPECT_NE(thin->find("in the plate passed through thin bone"), std::string::npos) << *thin;
  EXPECT_FALSE(term.rejection_reason(at_rest, flat_face(0.0), flat_face(1.4)));
  // Also for tissue that was in contact before.
  EXPECT_TRUE(term.rejection_reason(lifted(0.3), flat_face(0.0), flat_face(0.0)));
}

TEST(BonePassage, IsFoundIfThePlateIsBehindTheFaceInTheEnd) {
  RigidObstacle obstacle = plate();
  const RigidTransform at_rest = RigidTransform::Identity();
  obstacle.X_LB = lifted(3.0);
  const auto at_L = find_passage(obstacle, kFace, at_rest, flat_face(0.1), flat_face(0.1));
  ASSERT_TRUE(at_L);
  EXPECT_NEAR(at_L->z(), 0.1, 1e-12);
  // Not if the face is carried along, nor if the plate ends below it.
  EXPECT_FALSE(find_passage(obstacle, kFace, at_rest, flat_face(0.1), flat_face(3.1)));
  obstacle.X_LB = lifted(0.9);
  EXPECT_FALSE(find_passage(obstacle, kFace, at_rest, flat_face(0.1), flat_face(0.1)));
}

TEST(ContactTerm, TheHardeningTermGivesFourTimesYoungsModulusAtTheTolerance) {
  constexpr double kYoung_mpa = 0.015, kTolerance_mm = 0.05;
  ContactTerm term(flat_face(0.0), kFace, slab(),
                   {.law = hardening_law(0.0, kYoung_mpa, kTolerance_mm), .contact_snap_mm = 0.5});
  term.set_pose(lifted(kTolerance_mm));
  EXPECT_NEAR(term.summarize(flat_face(0.0)).force_L_n.z(), 4.0 * kYoung_mpa * kFaceArea_mm2, 1e-6);
  term.set_pose(lifted(2.0 * kTolerance_mm));
  EXPECT_NEAR(term.summarize(flat_face(0.0)).force_L_n.z(), 16.0 * kYoung_mpa * kFaceArea_mm2,
              1e-6);
}

TEST(ContactTerm, DepthsAreMeasuredBetweenTheQuadraturePoints) {
  ContactTerm term(flat_face(0.0), kFace, slab(), options(0.0));
  std::vector<Vec3> x_L = flat_face(1.0);
  x_L[1].z() = -0.2;  // Only the corner dips into the slab.
  term.note_clearances(x_L);
  const ContactStatistics pressed = term.summarize(x_L);
  EXPECT_NEAR(pressed.max_penetration_increase_mm, 0.2, 1e-6);
}

TEST(ContactTerm, BvhNormalsHaveNoPotential) {
  const geometry::TriangleMesh sphere = test::make_icosphere(6.0, 2);
  const ContactTerm term(flat_face(6.0), kFace,
                         {bvh_distance_query(std::make_shared<const geometry::Bvh>(sphere), 2.0)},
                         options(0.5));
  EXPECT_FALSE(term.is_conservative(fem::DofMap::build(3, {}).value()));
}

TEST(ContactTerm, TheP99OfDepthExcludesTheDeepestPercentOfTheArea) {
  std::vector<Vec3> nodes;
  std::vector<mesh::Face> faces;
  for (int n = 0; n < 200; ++n) {  // Separate faces, one of them deep.
    const double x = -5.0 + 0.05 * n;
    const double z = n == 50 ? -1.0 : 0.0;
    const auto first = std::int32_t(nodes.size());
    nodes.insert(nodes.end(), {{x, 0.0, z}, {x, 0.03, z}, {x + 0.03, 0.0, z}});
    faces.push_back({mesh::FaceShape::kTri3, {first, first + 1, first + 2}});
  }
  ContactTerm term(nodes, faces, slab(), options(0.0));
  for (Vec3& x : nodes) x.z() -= 0.25;
  nodes[150].z() = nodes[151].z() = nodes[152].z() = -1.9;
  const ContactStatistics pressed = term.summarize(nodes);
  EXPECT_NEAR(pressed.max_penetration_increase_mm, 0.9, 1e-6);
  EXPECT_NEAR(pressed.p99_penetration_increase_mm, 0.25, 1e-6);
}

TEST(ContactTerm, CountsThePointsInContact) {
  ContactTerm term(flat_face(0.0), kFace, slab(), options(0.5));
  EXPECT_EQ(evaluate(term, 0, flat_face(0.0)).contacts, 0);
  term.set_pose(lifted(1.0));
  EXPECT_EQ(evaluate(term, 0, flat_face(0.0)).contacts, 12);
}

TEST(ContactTerm, AStateBeyondTheBandIsInadmissibleAndTheMessageNamesTheBand) {
  const ContactTerm term(flat_face(0.0), kFace, slab(), options(0.5));
  EXPECT_TRUE(evaluate(term, 0, flat_face(-1.0)).admissible);
  EXPECT_FALSE(evaluate(term, 0, flat_face(-3.5)).admissible);
  const std::string cause = term.inadmissible_cause();
  EXPECT_NE(cause.find("in the plate than its distance field reaches"), std::string::npos) << cause;
  EXPECT_NE(cause.find("field.band_mm"), std::string::npos) << cause;
  const double band_mm = slab().distance_query_B->max_distance_mm();
  EXPECT_NE(cause.find(fmt::format("{:.2f} mm", band_mm)), std::string::npos) << cause;
}

}  // namespace
}  // namespace lefort::contact::test_contact_term
