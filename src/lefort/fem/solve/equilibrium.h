/// \file
/// Equilibrium of all force terms under prescribed displacements.
#pragma once

#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/linear/linear_solver.h>

#include <span>

namespace lefort::fem {

/// Sets the near null space of multigrid to the rigid-body modes of the free components.
/// \param linear_solver  receives positions and axes of the components.
/// \param assembler      which components are free.
void set_near_null_space(linear::LinearSolver& linear_solver, const Assembler& assembler);

/// Finds an equilibrium near `start`.
///
/// If the prescribed displacements differ from those in `start`, the free components are first
/// displaced by the linear response du_f of the start: K_ff du_f = -r_f - K_fp du_p, where f are
/// the free and p the prescribed components. Without the response, elements next to prescribed
/// nodes could invert. It is omitted if the energy is lower without it, if it cannot be computed,
/// if it inverts elements, or if max_step_length does not allow it. If the state is then
/// inadmissible, the outcome is kInadmissibleStart and a smaller increment is needed
/// (load_steps.h).
///
/// \param assembler      terms, reference positions, free components.
/// \param prescribed     exactly the components prescribed in assembler.dofs().
/// \param start          displacements of all components [mm], admissible.
/// \param linear_solver  as in solve_newton().
/// \param options        as in solve_newton(); round_off_n has 3 entries per node, or none.
/// \param progress       as in solve_newton().
/// \returns as solve_newton(); x holds the displacements of all components [mm].
[[nodiscard]] NewtonOutcome find_equilibrium(const Assembler& assembler,
                                             std::span<const PrescribedDisplacement> prescribed,
                                             const VectorX& start,
                                             linear::LinearSolver& linear_solver,
                                             const NewtonOptions& options = {},
                                             Progress& progress = Progress::none());

}  // namespace lefort::fem
