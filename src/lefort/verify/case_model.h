/// \file
/// Body, boundary conditions and loads of a verification case, and its equilibrium.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/fem/loads/dead_load.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/materials/material.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/mesh/volume_mesh.h>

#include <functional>
#include <vector>

namespace lefort::verify {

/// Material of most cases: the decoupled neo-Hookean law with VolumetricForm::kQuadraticLog; mu and
/// kappa are the shear and bulk modulus at small strain.
[[nodiscard]] fem::Material decoupled_neo_hookean(double mu_mpa, double kappa_mpa);

/// An additional force term that depends on the load fraction.
struct ExtraTerm {
  const fem::ForceTerm* term = nullptr;      ///< Not owned.
  std::function<void(double)> set_fraction;  ///< Called with the load fraction, 0 to 1.
};

struct CaseModel {
  mesh::VolumeMesh mesh;
  fem::RegionMaterials materials;
  /// At a load fraction, 0 to 1; always the same nodes and components.
  std::function<std::vector<fem::PrescribedDisplacement>(double fraction)> prescribed;
  std::vector<fem::NodalForce> forces = {};  ///< At full load.
  std::vector<ExtraTerm> extra = {};
  fem::VolumetricIntegration volumetric_integration = fem::VolumetricIntegration::kMeanDilatation;
};

struct SolveOptions {
  int increments = 1;                 ///< Planned number; a failed increment is halved.
  double relative_tolerance = 1e-10;  ///< Of Newton's method.
  /// Of Newton's method; for a single element, in which no forces cancel.
  double absolute_tolerance_n = 0.0;
  /// Called at each equilibrium; may be empty.
  std::function<void(double fraction, const VectorX& u)> on_increment = {};
};

struct Equilibrium {
  VectorX u;                               ///< Displacements, 3 per node [mm].
  VectorX reaction_n;                      ///< Reactions, 3 per node; round-off at free components.
  std::vector<fem::LoadAttempt> attempts;  ///< Of all increments.
};

/// \param model     to solve.
/// \param options   increments and tolerances.
/// \param progress  may stop the solve.
/// \returns the equilibrium at full load, or an error of fem::make_element_terms(),
///   fem::DofMap::build() or fem::LoadStepper::advance_to().
[[nodiscard]] Result<Equilibrium> solve(const CaseModel& model, const SolveOptions& options,
                                        Progress& progress);

/// \returns a function of the load fraction: the displacements at full load times the fraction.
[[nodiscard]] std::function<std::vector<fem::PrescribedDisplacement>(double)> in_proportion(
    std::vector<fem::PrescribedDisplacement> at_full_load);

/// Appends a prescribed displacement of one component of `nodes` to `prescribed`.
void prescribe(const std::vector<std::int32_t>& nodes, int component, double displacement_mm,
               std::vector<fem::PrescribedDisplacement>& prescribed);

/// Numbers of the nodes whose reference position satisfies `is_in`, ascending.
[[nodiscard]] std::vector<std::int32_t> nodes_where(const mesh::VolumeMesh& mesh,
                                                    const std::function<bool(const Vec3&)>& is_in);

/// Sum of the forces of `nodes` [N]; `forces_n` has 3 entries per node.
[[nodiscard]] Vec3 sum_over(const std::vector<std::int32_t>& nodes, const VectorX& forces_n);

}  // namespace lefort::verify
