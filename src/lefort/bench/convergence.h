/// \file
/// The paper's Figure 5 rerun: how the residual falls by one way of detecting contact or another.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/plan.h>
#include <lefort/predict/predict_face.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::bench {

/// A body, bones and their ways.
struct ConvergenceCase {
  std::string name;
  /// Cases of one name here share the mesh and differ in the number of steps alone.
  std::string mesh_name;
  predict::FaceModel model;
  std::vector<geometry::RigidPath> paths;
  predict::PredictionOptions options;  ///< How contact is detected is the method's.
};

/// One way to detect and integrate contact.
struct ContactMethod {
  std::string_view name;
  contact::DetectionMethod detection;
  contact::Integration integration;
  std::optional<double> penetration_tolerance_mm = std::nullopt;
};

/// The paper's baseline, the paper's own, ours; ours with multipliers.
[[nodiscard]] std::vector<ContactMethod> contact_methods();

/// An edge of a cube, and a coarse sphere, pressed into a block of tissue and slid along it: where
/// normals jump the reason is plain to see.
[[nodiscard]] Result<std::vector<ConvergenceCase>> synthetic_cases(Progress& progress);

struct ConvergenceOptions {
  std::filesystem::path output;
  std::vector<ContactMethod> methods = contact_methods();
  double relative_tolerance = 1e-8;  ///< Of Newton, for all.
  int max_iterations = 60;           ///< Of Newton for one increment, for all.
};

/// Follows each case by each method: same mesh, from rest, by the same rules for increments and for
/// stopping.
///
/// Writes convergence.csv (every Newton iteration), convergence.md (table; how far apart the faces
/// of one mesh are after different numbers of steps), and for each case two plots, NAME-walk.svg
/// and NAME-first-step.svg, into the output folder; all of them anew after every step, so that a
/// run that is stopped keeps what it has found.
/// \returns the table as Markdown; kFileUnwritable, kCancelled, or what predict_face() refuses.
[[nodiscard]] Result<std::string> run_convergence(std::span<const ConvergenceCase> cases,
                                                  const ConvergenceOptions& options,
                                                  Progress& progress);

}  // namespace lefort::bench
