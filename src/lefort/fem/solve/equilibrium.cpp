#include <lefort/core/check.h>
#include <lefort/fem/solve/equilibrium.h>

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lefort::fem {
namespace {

/// The equations of the free components; the prescribed ones are those of u.
class FreeComponents final : public NonlinearSystem {
 public:
  FreeComponents(const Assembler& assembler, VectorX u) : assembler_(assembler), u_(std::move(u)) {}

  [[nodiscard]] std::optional<ResidualState> residual_state(const VectorX& x) const override {
    std::optional<AssembledForces> forces = assembler_.forces(all(x));
    if (!forces) return std::nullopt;
    return ResidualState{.energy_mj = forces->energy_mj,
                         .residual_n = assembler_.dofs().free_part(forces->residual_n),
                         .follower_n = forces->follower_n.size() == 0
                                           ? VectorX()
                                           : assembler_.dofs().free_part(forces->follower_n),
                         .residual_reference_n = forces->residual_reference_n,
                         .energy_round_off_mj = forces->energy_round_off_mj,
                         .contacts = forces->contacts,
                         .deepest_mm = forces->deepest_mm};
  }

  [[nodiscard]] std::string inadmissible_cause(const VectorX& x) const override {
    return assembler_.inadmissible_cause(all(x));
  }

  [[nodiscard]] linear::SparseMatrix tangent(const VectorX& x, Tangent kind) const override {
    return assembler_.tangent(all(x), kind);
  }

  [[nodiscard]] linear::SparseMatrix antisymmetric_tangent(const VectorX& x) const override {
    return assembler_.antisymmetric_tangent(all(x));
  }

  [[nodiscard]] VectorX all(const VectorX& x) const {
    return assembler_.dofs().with_free_part(u_, x);
  }

 private:
  const Assembler& assembler_;
  VectorX u_;
};

/// Below this change of the prescribed displacements there is no linear response [mm].
constexpr double kMinChange_mm = 1e-9;

/// Tolerance of the linear response; Newton's method corrects the rest.
constexpr double kResponseTolerance = 1e-3;

/// \param moved  `start` with the new prescribed displacements.
/// \returns `moved` with the linear response of the free components at `start`; or `moved` itself
///   if that has less energy.
VectorX with_linear_response(const Assembler& assembler, const VectorX& start, const VectorX& moved,
                             linear::LinearSolver& linear_solver, const NewtonOptions& options) {
  const DofMap& dofs = assembler.dofs();
  enter(SolvePhase::kAssembly, options);
  const auto forces = assembler.forces(start);
  if (!forces) return moved;
  // Stabilized: an obstacle that has moved into the body can make the exact tangent indefinite.
  const VectorX residual_n =
      forces->residual_n + assembler.tangent_times(start, moved - start, Tangent::kStabilized);
  const linear::SparseMatrix K = assembler.tangent(start, Tangent::kStabilized);
  enter(SolvePhase::kFactorization, options);
  const auto du = linear_solver.solve(K, -dofs.free_part(residual_n), kResponseTolerance,
                                      [&] { enter(SolvePhase::kSolve, options); });
  enter(SolvePhase::kAssembly, options);
  if (!du) return moved;

  VectorX response = dofs.with_free_part(moved, dofs.free_part(start) + *du);
  if (options.max_step_length && options.max_step_length(moved, response - moved) < 1.0)
    return moved;
  const auto after = assembler.forces(response);
  if (!after) return moved;
  const auto forces_moved = assembler.forces(moved);
  return forces_moved && energy_change_mj(*forces_moved, moved, *after, response) > 0.0 ? moved
                                                                                        : response;
}

}  // namespace

void set_near_null_space(linear::LinearSolver& linear_solver, const Assembler& assembler) {
  const DofMap& dofs = assembler.dofs();
  const std::span<const Vec3> nodes_L = assembler.nodes_L();
  LEFORT_CHECK(Index(nodes_L.size()) == dofs.node_count());
  std::vector<Vec3> points_L;
  std::vector<std::int32_t> components;
  for (Index node = 0; node < dofs.node_count(); ++node)
    for (std::int32_t c = 0; c < 3; ++c) {
      if (dofs.free_number(3 * node + c) < 0) continue;
      points_L.push_back(nodes_L[std::size_t(node)]);
      components.push_back(c);
    }
  linear_solver.set_near_null_space(std::move(points_L), std::move(components));
}

NewtonOutcome find_equilibrium(const Assembler& assembler,
                               std::span<const PrescribedDisplacement> prescribed,
                               const VectorX& start, linear::LinearSolver& linear_solver,
                               const NewtonOptions& options, Progress& progress) {
  const DofMap& dofs = assembler.dofs();
  LEFORT_CHECK(start.size() == 3 * dofs.node_count());
  set_near_null_space(linear_solver, assembler);
  const VectorX moved = dofs.with_prescribed(start, prescribed);
  const bool is_stationary =
      dofs.free_count() == 0 || (moved - start).lpNorm<Eigen::Infinity>() <= kMinChange_mm;
  const VectorX guess =
      is_stationary ? moved : with_linear_response(assembler, start, moved, linear_solver, options);
  const FreeComponents body(assembler, guess);
  NewtonOptions of_free_part = options;
  if (options.round_off_n.size() > 0)
    of_free_part.round_off_n = dofs.free_part(options.round_off_n);
  if (options.max_step_length)
    of_free_part.max_step_length = [&](const VectorX& x, const VectorX& dx) {
      const VectorX from = body.all(x);
      return options.max_step_length(from, body.all(x + dx) - from);
    };
  NewtonOutcome outcome =
      solve_newton(body, dofs.free_part(guess), linear_solver, of_free_part, progress);
  outcome.x = body.all(outcome.x);
  return outcome;
}

}  // namespace lefort::fem
