#include <lefort/contact/solve_active_set.h>
#include <lefort/contact/weighted_contact_term.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/mesh/box_grid.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lefort::solve::test_weighted_indentation {
namespace {

using std::numbers::pi;

constexpr double kYoung_mpa = 1.0, kPoisson = 0.3;
constexpr double kPlane_mpa = kYoung_mpa / (1.0 - kPoisson * kPoisson);  // E*.
constexpr double kDepth_mm = 0.02;
constexpr double kRadius_mm = 1.0;  ///< Of contact, for all indenters.
constexpr double kFar_mm = 8.0;     ///< Side of the quarter of the block.

/// A body of revolution about z that touches the origin from above.
struct Indenter {
  std::string name;
  std::function<double(double r)> height_mm;
  double force_n;  ///< On the whole of it, of a half-space.
};

/// Hertz; and I. N. Sneddon, The relation between load and penetration, Int. J. Eng. Sci. 3 (1965),
/// for a cone.
std::vector<Indenter> indenters() {
  const double sphere_mm = kRadius_mm * kRadius_mm / kDepth_mm;
  const double slope = 2.0 * kDepth_mm / (pi * kRadius_mm);
  return {{"sphere", [=](double r) { return sphere_mm - std::sqrt(sphere_mm * sphere_mm - r * r); },
           4.0 / 3.0 * kPlane_mpa * kRadius_mm * kDepth_mm},
          {"cone", [=](double r) { return slope * r; }, kPlane_mpa * kRadius_mm * kDepth_mm}};
}

/// Closed surface of an indenter, 3 mm high and wider than the block.
geometry::TriangleMesh surface_of(const Indenter& indenter) {
  constexpr int kRings = 60, kSides = 96;
  constexpr double kOuter_mm = 1.5 * kFar_mm;
  geometry::TriangleMesh mesh;
  mesh.vertices = {Vec3::Zero(), Vec3(0, 0, 3)};
  const auto add_ring = [&](double r, double z) {
    for (int s = 0; s < kSides; ++s) {
      const double angle = 2.0 * pi * s / kSides;
      mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  };
  for (int ring = 1; ring <= kRings; ++ring)
    add_ring(kOuter_mm * ring / kRings, indenter.height_mm(kOuter_mm * ring / kRings));
  add_ring(kOuter_mm, 3.0);
  const auto at = [](int ring, int side) {
    return std::int32_t(2 + ring * kSides + (side % kSides));
  };
  for (int s = 0; s < kSides; ++s) {
    mesh.triangles.push_back({0, at(0, s + 1), at(0, s)});
    for (int ring = 0; ring < kRings; ++ring) {
      mesh.triangles.push_back({at(ring, s), at(ring, s + 1), at(ring + 1, s + 1)});
      mesh.triangles.push_back({at(ring, s), at(ring + 1, s + 1), at(ring + 1, s)});
    }
    mesh.triangles.push_back({1, at(kRings, s), at(kRings, s + 1)});
  }
  return mesh;
}

/// Boussinesq: displacement of the half-space z <= 0 under a point force downwards at its origin.
Vec3 boussinesq(const Vec3& p, double force_n) {
  const double mu_mpa = kYoung_mpa / (2.0 + 2.0 * kPoisson);
  const double depth = -p.z(), rho = p.norm();
  const double unit = force_n / (4.0 * pi * mu_mpa);
  const double outwards =
      unit * (depth / std::pow(rho, 3) - (1.0 - 2.0 * kPoisson) / (rho * (rho + depth)));
  return {outwards * p.x(), outwards * p.y(),
          -unit * (2.0 * (1.0 - kPoisson) / rho + depth * depth / std::pow(rho, 3))};
}

/// A quarter of a block below z = 0, with small cells around the edge of contact.
mesh::VolumeMesh quarter() {
  constexpr int kCells = 14;
  constexpr double kGrading = 3.5;
  mesh::VolumeMesh mesh =
      mesh::make_box(mesh::ElementShape::kHex8, {kCells, kCells, kCells}, Vec3::Ones());
  const auto position = [](double s) {
    return kFar_mm * std::sinh(kGrading * s) / std::sinh(kGrading);
  };
  for (Vec3& p : mesh.nodes_L) p = Vec3(position(p.x()), position(p.y()), -position(1.0 - p.z()));
  return mesh;
}

std::vector<fem::PrescribedDisplacement> supports(const mesh::VolumeMesh& mesh, double force_n) {
  std::vector<fem::PrescribedDisplacement> all;
  for (std::int32_t n = 0; n < std::int32_t(mesh.node_count()); ++n) {
    const Vec3& p = mesh.nodes_L[std::size_t(n)];
    const bool is_far = std::max({p.x(), p.y(), -p.z()}) > kFar_mm - 1e-9;
    const Vec3 u = is_far ? boussinesq(p, force_n) : Vec3::Zero();
    for (int c = 0; c < 3; ++c)
      if (is_far || (c < 2 && std::abs(p[c]) < 1e-9)) all.push_back({n, c, u[c]});
  }
  return all;
}

/// \returns the force on the whole indenter.
double pressed_force_n(const Indenter& indenter) {
  const mesh::VolumeMesh mesh = quarter();
  auto surface = std::make_shared<const geometry::TriangleMesh>(surface_of(indenter));
  const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(*surface, {.resolution = 256, .band_mm = 0.6, .smooth = true})
          .value());
  contact::RigidObstacle bone{
      contact::field_distance_query(field, contact::DetectionMethod::kSmooth, surface).value()};
  contact::WeightedContactTerm term(mesh.nodes_L, mesh.face_sets.at("z1"), {bone},
                                    {.stiffness_mpa_per_mm = contact::weighted_stiffness_mpa_per_mm(
                                         kYoung_mpa, 0.01 * kDepth_mm)});
  bone.X_LB.translation().z() = -kDepth_mm;
  term.set_pose(0, bone.X_LB);
  const auto elements = fem::make_element_terms(
      mesh, {{0, fem::NeoHookean::from_young_poisson(kYoung_mpa, kPoisson).value()}});
  EXPECT_TRUE(elements);
  std::vector<const fem::ForceTerm*> terms{&term};
  for (const auto& element : *elements) terms.push_back(element.get());
  const auto prescribed = supports(mesh, indenter.force_n);
  const fem::Assembler assembler(mesh.nodes_L,
                                 fem::DofMap::build(mesh.node_count(), prescribed).value(), terms);
  linear::LinearSolver linear_solver;
  contact::WeightedContactTerm* const contacts[] = {&term};
  const fem::NewtonOutcome end = contact::solve_active_set(
      contacts, mesh.nodes_L, {term.active_set(mesh.nodes_L)}, VectorX::Zero(3 * mesh.node_count()),
      100, [&](const VectorX& from, int max_iterations) {
        fem::NewtonOptions newton;
        newton.relative_tolerance = 1e-8;
        newton.max_iterations = max_iterations;
        return fem::find_equilibrium(assembler, prescribed, from, linear_solver, newton,
                                     Progress::none());
      });
  EXPECT_TRUE(end.converged()) << end.reason;
  std::vector<Vec3> x_L = mesh.nodes_L;
  for (std::size_t n = 0; n < x_L.size(); ++n) x_L[n] += end.x.segment<3>(3 * Index(n));
  return -4.0 * term.summarize(x_L).front().force_L_n.z();
}

/// Closed forms of a half-space under small strain: Hertz for a sphere, Sneddon for a cone.
TEST(WeightedIndentation, ForcesOfSphereAndConeAreThoseOfHertzAndSneddon) {
  for (const Indenter& indenter : indenters())
    EXPECT_NEAR(pressed_force_n(indenter) / indenter.force_n, 1.0, 0.02) << indenter.name;
}

}  // namespace
}  // namespace lefort::solve::test_weighted_indentation
