/// \file
/// A body, what holds and what loads it, and its equilibrium: what every case solves.
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

/// What most cases are made of: isochoric neo-Hookean, the volume by VolumetricForm::kQuadraticLog.
[[nodiscard]] fem::Material split_neo_hookean(double mu_mpa, double kappa_mpa);

/// A further force whose size follows the load.
struct ExtraTerm {
  const fem::ForceTerm* term = nullptr;      ///< Not owned.
  std::function<void(double)> set_fraction;  ///< Called with the share of the load, 0 to 1.
};

struct CaseModel {
  mesh::VolumeMesh mesh;
  fem::RegionMaterials materials;
  /// At a share of the load, 0 to 1; always the same nodes and components.
  std::function<std::vector<fem::PrescribedDisplacement>(double fraction)> prescribed;
  std::vector<fem::NodalForce> forces = {};  ///< At full load.
  std::vector<ExtraTerm> extra = {};
  fem::VolumetricIntegration volumetric_integration = fem::VolumetricIntegration::kMeanDilatation;
};

struct SolveOptions {
  int increments = 1;                 ///< To begin with; an increment that fails is halved.
  double relative_tolerance = 1e-10;  ///< Of Newton's method.
  double absolute_tolerance_n = 0.0;  ///< Likewise; for a lone element, where no forces cancel.
  /// Told each equilibrium on the way; may be empty.
  std::function<void(double fraction, const VectorX& u)> on_increment = {};
};

struct Equilibrium {
  VectorX u;           ///< Displacements, 3 per node [mm].
  VectorX reaction_n;  ///< What the supports exert, 3 per node; round-off at free components.
  std::vector<fem::LoadAttempt> attempts;  ///< All that was tried on the way.
};

/// \returns the equilibrium at full load, or what make_element_terms(), DofMap::build() and
///   LoadStepper::advance_to() refuse.
[[nodiscard]] Result<Equilibrium> solve(const CaseModel& model, const SolveOptions& options,
                                        Progress& progress);

/// Displacements that grow with the load.
[[nodiscard]] std::function<std::vector<fem::PrescribedDisplacement>(double)> in_proportion(
    std::vector<fem::PrescribedDisplacement> at_full_load);

/// Prescribes one component of `nodes`.
void hold(const std::vector<std::int32_t>& nodes, int component, double displacement_mm,
          std::vector<fem::PrescribedDisplacement>& prescribed);

/// Numbers of the nodes at rest where `is_in` holds, ascending.
[[nodiscard]] std::vector<std::int32_t> nodes_where(const mesh::VolumeMesh& mesh,
                                                    const std::function<bool(const Vec3&)>& is_in);

/// Sum over `nodes` of the forces in an all vector [N].
[[nodiscard]] Vec3 sum_over(const std::vector<std::int32_t>& nodes, const VectorX& forces_n);

}  // namespace lefort::verify
