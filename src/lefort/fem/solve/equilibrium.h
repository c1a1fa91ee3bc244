/// \file
/// The displacement at which all force terms balance under given boundary displacements.
#pragma once

#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/linear/linear_solver.h>

#include <span>

namespace lefort::fem {

/// Prepares multigrid for the free components of `assembler`: their nodes and axes.
void set_near_null_space(linear::LinearSolver& linear_solver, const Assembler& assembler);

/// Finds the equilibrium next to `start`.
///
/// If the prescribed displacements differ from those in `start`, the free nodes first follow by the
/// linear response of the start state; moving the boundary alone would crush the elements beside
/// it. Where even that turns an element inside out, the outcome is kInadmissibleStart, and a
/// smaller increment is needed (load_steps.h).
///
/// \param assembler   terms, reference positions, free components.
/// \param prescribed  names exactly the components prescribed in assembler.dofs().
/// \param start       displacements of all components [mm], admissible.
/// \returns as solve_newton(); x holds the displacements of all components.
[[nodiscard]] NewtonOutcome find_equilibrium(const Assembler& assembler,
                                             std::span<const PrescribedDisplacement> prescribed,
                                             const VectorX& start,
                                             linear::LinearSolver& linear_solver,
                                             const NewtonOptions& options = {},
                                             Progress& progress = Progress::none());

}  // namespace lefort::fem
