#include <lefort/core/check.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/verify/case_model.h>

#include <optional>
#include <utility>

namespace lefort::verify {

fem::Material decoupled_neo_hookean(double mu_mpa, double kappa_mpa) {
  return fem::DecoupledLaw<fem::IsochoricNeoHookean>{
      .isochoric = {.mu_mpa = mu_mpa},
      .volume = {.form = fem::VolumetricForm::kQuadraticLog, .kappa_mpa = kappa_mpa}};
}

Result<Equilibrium> solve(const CaseModel& model, const SolveOptions& options, Progress& progress) {
  LEFORT_TRY(const auto element_terms,
             fem::make_element_terms(model.mesh, model.materials, model.volumetric_integration));
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : element_terms) terms.push_back(term.get());
  for (const ExtraTerm& extra : model.extra) terms.push_back(extra.term);
  std::optional<fem::DeadLoad> dead;
  if (!model.forces.empty()) terms.push_back(&dead.emplace(model.mesh.nodes_L, model.forces));

  LEFORT_TRY(auto dofs, fem::DofMap::build(model.mesh.node_count(), model.prescribed(1.0)));
  const fem::Assembler assembler(model.mesh.nodes_L, std::move(dofs), terms);
  linear::LinearSolver linear_solver;
  fem::NewtonOptions newton;
  newton.relative_tolerance = options.relative_tolerance;
  newton.absolute_tolerance_n = options.absolute_tolerance_n;
  const auto solve_at = [&](double fraction, const VectorX& start) {
    if (dead) dead->set_factor(fraction);
    for (const ExtraTerm& extra : model.extra)
      if (extra.set_fraction) extra.set_fraction(fraction);
    return fem::find_equilibrium(assembler, model.prescribed(fraction), start, linear_solver,
                                 newton, progress);
  };
  fem::LoadStepOptions steps;
  steps.first_increment = 1.0 / options.increments;
  steps.growth_factor = 1.0;
  steps.max_attempts = 200;
  fem::LoadStepper stepper({.t = 0.0, .u = VectorX::Zero(3 * model.mesh.node_count())}, solve_at,
                           steps);
  const auto on_state = [&](const fem::LoadState& state) -> Result<void> {
    if (options.on_increment) options.on_increment(state.t, state.u);
    return {};
  };
  LEFORT_TRY_VOID(stepper.advance_to(1.0, progress, on_state));

  const auto forces = assembler.forces(stepper.state().u);
  LEFORT_CHECK(forces.has_value());
  return Equilibrium{
      .u = stepper.state().u, .reaction_n = forces->residual_n, .attempts = stepper.attempts()};
}

std::function<std::vector<fem::PrescribedDisplacement>(double)> in_proportion(
    std::vector<fem::PrescribedDisplacement> at_full_load) {
  return [full = std::move(at_full_load)](double fraction) {
    std::vector<fem::PrescribedDisplacement> now = full;
    for (fem::PrescribedDisplacement& one : now) one.displacement_mm *= fraction;
    return now;
  };
}

void prescribe(const std::vector<std::int32_t>& nodes, int component, double displacement_mm,
               std::vector<fem::PrescribedDisplacement>& prescribed) {
  for (const std::int32_t node : nodes)
    prescribed.push_back(
        {.node = node, .component = component, .displacement_mm = displacement_mm});
}

std::vector<std::int32_t> nodes_where(const mesh::VolumeMesh& mesh,
                                      const std::function<bool(const Vec3&)>& is_in) {
  std::vector<std::int32_t> nodes;
  for (std::size_t n = 0; n < mesh.nodes_L.size(); ++n)
    if (is_in(mesh.nodes_L[n])) nodes.push_back(std::int32_t(n));
  return nodes;
}

Vec3 sum_over(const std::vector<std::int32_t>& nodes, const VectorX& forces_n) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t node : nodes) sum += forces_n.segment<3>(3 * Index(node));
  return sum;
}

}  // namespace lefort::verify
