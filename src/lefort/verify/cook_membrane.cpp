#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cook_membrane.h>

#include <memory>

namespace lefort::verify {
namespace {

constexpr double kMembraneLength_mm = 48.0;
constexpr double kRoot_mm = 44.0;  // Height of the clamped end.
constexpr double kEnd_mm = 16.0;   // Height of the other end.
constexpr double kRise_mm = 44.0;  // Of the lower edge, between the ends.
constexpr double kTraction_mpa = 6.25;

/// Map from the unit cube to the membrane. Cells are divided along the diagonal on which both
/// coordinates of the cube increase; with the first one reversed it is the shorter one.
Vec3 map_to_membrane(const Vec3& unit, Diagonal diagonal, double thickness_mm) {
  const bool is_shorter = diagonal == Diagonal::kShorter;
  const double along = is_shorter ? unit.y() : unit.x();
  const double up = is_shorter ? 1.0 - unit.x() : unit.y();
  const double height_mm = kRoot_mm + (kEnd_mm - kRoot_mm) * along;
  return {kMembraneLength_mm * along, kRise_mm * along + height_mm * up, thickness_mm * unit.z()};
}

void fix_component(const std::vector<std::int32_t>& nodes, int component,
                   std::vector<fem::PrescribedDisplacement>& prescribed) {
  for (const std::int32_t node : nodes)
    prescribed.push_back({.node = node, .component = component});
}

}  // namespace

fem::Material cook_material() {
  constexpr double kYoung_mpa = 240.565;
  constexpr double kMembranePoisson = 0.4999;
  return decoupled_neo_hookean(kYoung_mpa / (2.0 * (1.0 + kMembranePoisson)),
                               kYoung_mpa / (3.0 * (1.0 - 2.0 * kMembranePoisson)));
}

CookMembrane make_cook_membrane(mesh::ElementShape shape, int cells, Diagonal diagonal) {
  CookMembrane membrane;
  membrane.mesh = mesh::make_box(shape, {cells, cells, 1}, Vec3::Ones());
  std::vector<Vec3>& nodes_L = membrane.mesh.nodes_L;
  for (Vec3& node : nodes_L) node = map_to_membrane(node, diagonal, kMembraneLength_mm / cells);
  const Vec3 tip(kMembraneLength_mm, kRise_mm + kEnd_mm, kMembraneLength_mm / cells);
  for (std::size_t n = 0; n < nodes_L.size(); ++n)
    if ((nodes_L[n] - tip).norm() < 1e-9) membrane.tip = std::int32_t(n);

  const auto& sets = membrane.mesh.node_sets;
  const bool is_shorter = diagonal == Diagonal::kShorter;
  const char* const root = is_shorter ? "y0" : "x0";
  fix_component(sets.at(root), 0, membrane.prescribed);
  fix_component(sets.at(root), 1, membrane.prescribed);
  fix_component(sets.at("z0"), 2, membrane.prescribed);
  fix_component(sets.at("z1"), 2, membrane.prescribed);
  membrane.forces =
      fem::traction_forces(nodes_L, membrane.mesh.face_sets.at(is_shorter ? "y1" : "x1"),
                           Vec3(0.0, kTraction_mpa, 0.0))
          .value();
  return membrane;
}

Result<Vec3> solve_cook_membrane(const CookMembrane& membrane, const fem::Material& material,
                                 fem::VolumetricIntegration volumetric_integration,
                                 Progress& progress) {
  LEFORT_TRY(const auto terms,
             fem::make_element_terms(membrane.mesh, {{0, material}}, volumetric_integration));
  LEFORT_TRY(fem::DofMap dofs, fem::DofMap::build(membrane.mesh.node_count(), membrane.prescribed));
  fem::DeadLoad load(membrane.mesh.nodes_L, membrane.forces);
  std::vector<const fem::ForceTerm*> all{&load};
  for (const auto& term : terms) all.push_back(term.get());
  const fem::Assembler assembler(membrane.mesh.nodes_L, std::move(dofs), all);

  linear::LinearSolver solver;
  fem::LoadStepper stepper({.t = 0.0, .u = VectorX::Zero(3 * membrane.mesh.node_count())},
                           [&](double t, const VectorX& start) {
                             load.set_factor(t);
                             return fem::find_equilibrium(assembler, membrane.prescribed, start,
                                                          solver, {.max_iterations = 60}, progress);
                           });
  LEFORT_TRY_VOID(stepper.advance_to(1.0, progress));
  return Vec3(stepper.state().u.segment<3>(3 * Index(membrane.tip)));
}

}  // namespace lefort::verify
