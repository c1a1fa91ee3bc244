#include <lefort/fem/loads/dead_load.h>

#include <gtest/gtest.h>

#include <limits>

#include "fem/body.h"
#include "support/box_mesh.h"

namespace lefort::fem::test_dead_load {
namespace {

using mesh::ElementShape;
using test::box_mesh;

const Vec3 kSize_mm(3, 2, 4);

/// A distorted box of the given size.
mesh::VolumeMesh box_of(ElementShape shape) {
  return box_mesh({.cells = {2, 3, 2}, .size_mm = kSize_mm, .distortion = 0.15, .shape = shape});
}

Vec3 resultant(const std::vector<NodalForce>& forces) {
  Vec3 sum = Vec3::Zero();
  for (const NodalForce& force : forces) sum += force.force_n;
  return sum;
}

/// \returns the sum of x (x) f: the work of the forces in a linear field.
Mat3 first_moment(const mesh::VolumeMesh& mesh, const std::vector<NodalForce>& forces) {
  Mat3 sum = Mat3::Zero();
  for (const NodalForce& force : forces)
    sum += mesh.nodes_L[std::size_t(force.node)] * force.force_n.transpose();
  return sum;
}

class DeadLoads : public testing::TestWithParam<ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, DeadLoads, testing::ValuesIn(test::kAllElements),
                         test::shape_name);

TEST_P(DeadLoads, NodalForcesOfATractionDoItsWorkInALinearField) {
  const auto mesh = box_of(GetParam());
  const Vec3 t(0.3, -0.2, 0.7);
  const auto forces = traction_forces(mesh.nodes_L, mesh.face_sets.at("x1"), t).value();
  const double area = kSize_mm[1] * kSize_mm[2];
  const Vec3 center(kSize_mm[0], 0.5 * kSize_mm[1], 0.5 * kSize_mm[2]);
  EXPECT_LT((resultant(forces) - area * t).norm(), 1e-13);
  EXPECT_LT((first_moment(mesh, forces) - area * center * t.transpose()).norm(), 1e-12);
  for (const NodalForce& force : forces)
    EXPECT_EQ(mesh.nodes_L[std::size_t(force.node)].x(), kSize_mm[0]);
}

TEST_P(DeadLoads, NodalForcesOfABodyForceDoItsWorkInALinearField) {
  const auto mesh = box_of(GetParam());
  const Vec3 b(0.1, 0.5, -0.4);
  const auto forces = body_forces(mesh, {{0, b}}).value();
  const double volume = kSize_mm.prod();
  EXPECT_LT((resultant(forces) - volume * b).norm(), 1e-12);
  EXPECT_LT((first_moment(mesh, forces) - 0.5 * volume * kSize_mm * b.transpose()).norm(), 1e-12);
}

TEST_P(DeadLoads, AHangingBarStretchesUnderItsWeightAsInTheClosedForm) {
  // Without lateral strain, du/dz = rho g (L - z) / E: the end sinks by rho g L^2 / (2 E).
  const double E = 2.0, L = 4.0, weight = 1e-4;
  auto mesh = box_mesh({.cells = {1, 1, 4}, .size_mm = {1, 1, L}, .shape = GetParam()});
  const DeadLoad load(mesh.nodes_L, body_forces(mesh, {{0, Vec3(0, 0, weight)}}).value());
  auto prescribed = prescribe_zero(mesh.node_sets.at("z0"));
  const test::Body body(std::move(mesh), {{0, NeoHookean::from_young_poisson(E, 0.0).value()}},
                        std::move(prescribed), {&load});
  const auto outcome = body.solve();
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  const std::vector<std::int32_t>& end = body.mesh.node_sets.at("z1");
  double sum_mm = 0.0;
  for (const std::int32_t node : end) sum_mm += outcome.x[3 * Index(node) + 2];
  const double expected_mm = weight * L * L / (2.0 * E);
  EXPECT_NEAR(sum_mm / double(end.size()), expected_mm, 2e-3 * expected_mm);
}

TEST(DeadLoad, ForcesAreConstantTimesTheFactor) {
  const std::vector<Vec3> nodes_L{Vec3(1, 2, 3), Vec3(4, 5, 6)};
  const Vec3 f(0.5, -1.0, 2.0);
  DeadLoad load(nodes_L, std::vector<NodalForce>{{.node = 1, .force_n = f}});
  ASSERT_EQ(load.item_count(), 1);
  EXPECT_EQ(load.nodes(0)[0], 1);
  load.set_factor(-3.0);
  VectorX residual = VectorX::Zero(3);
  LocalEquations local{.residual_n = Eigen::Map<VectorX>(residual.data(), 3),
                       .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(nullptr, 0, 0)};
  const std::vector<Vec3> x_L{nodes_L[1] + Vec3(0.1, 0.2, 0.3)};
  ASSERT_TRUE(load.evaluate(0, x_L, local));
  EXPECT_NEAR(local.energy_mj, 3.0 * (0.05 - 0.2 + 0.6), 1e-14);
  EXPECT_EQ(residual, 3.0 * f);
}

TEST(DeadLoad, RegionsThatAreNotListedHaveNoBodyForce) {
  auto mesh = box_mesh({.cells = {2, 1, 1}, .shape = ElementShape::kHex8});
  mesh.blocks[0].region = {4, 7};
  const auto forces = body_forces(mesh, {{7, Vec3(0, 0, 2)}}).value();
  EXPECT_EQ(forces.size(), 8U);
  EXPECT_NEAR(resultant(forces).z(), 1.0, 1e-15);
}

TEST(DeadLoad, RejectsInvalidFacesAndRegions) {
  const auto mesh = box_mesh({.cells = {1, 1, 1}, .shape = ElementShape::kHex8});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](const auto& result, ErrorCode code) {
    EXPECT_EQ(result.error().code, code);
    return result.error().message;
  };
  auto faces = mesh.face_sets.at("x1");
  EXPECT_EQ(
      message(traction_forces(mesh.nodes_L, faces, Vec3(0, nan, 0)), ErrorCode::kInvalidArgument),
      "traction: a component is not finite");
  faces[0].nodes[2] = 8;
  EXPECT_EQ(message(traction_forces(mesh.nodes_L, faces, Vec3::UnitX()), ErrorCode::kMeshInvalid),
            "face 0 names node 8, must be 0 to 7");
  faces[0].nodes[2] = faces[0].nodes[0];
  EXPECT_NE(message(traction_forces(mesh.nodes_L, faces, Vec3::UnitX()), ErrorCode::kMeshInvalid)
                .find("twice, its nodes must differ"),
            std::string::npos);
  auto with_nan = mesh.nodes_L;
  with_nan[std::size_t(mesh.face_sets.at("x1")[0].nodes[1])].y() = nan;
  EXPECT_EQ(traction_forces(with_nan, mesh.face_sets.at("x1"), Vec3::UnitX()).error().code,
            ErrorCode::kMeshInvalid);

  EXPECT_EQ(message(body_forces(mesh, {{3, Vec3::UnitX()}}), ErrorCode::kInvalidArgument),
            "body force of region 3: the volume mesh has no such region");
  EXPECT_EQ(body_forces(mesh, {{0, Vec3(nan, 0, 0)}}).error().code, ErrorCode::kInvalidArgument);
  auto flat = mesh;
  for (Vec3& node : flat.nodes_L) node.z() = 0.0;
  EXPECT_EQ(body_forces(flat, {{0, Vec3::UnitX()}}).error().code, ErrorCode::kElementInverted);
}

}  // namespace
}  // namespace lefort::fem::test_dead_load
