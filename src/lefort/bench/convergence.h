/// \file
/// Repeats Figure 5 of the paper: convergence of the residual with different methods of contact
/// detection.
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

/// A model, its paths and options.
struct ConvergenceCase {
  std::string name;
  /// Cases with the same name here have the same mesh and differ only in the number of steps.
  std::string mesh_name;
  predict::FaceModel model;
  std::vector<geometry::RigidPath> paths;
  /// Detection and penetration tolerance are replaced by those of the method, Newton's
  /// tolerance and iterations by those of ConvergenceOptions.
  predict::PredictionOptions options;
};

/// A method of detection and of the pressure of contact.
struct ContactMethod {
  std::string_view name;
  contact::DetectionMethod detection;
  std::optional<double> penetration_tolerance_mm = std::nullopt;
};

/// The baseline of the paper, the method of the paper, the smooth field, and the smooth field with
/// hardening contact (predict::contact_law()).
[[nodiscard]] std::vector<ContactMethod> contact_methods();

/// A cube edge and a coarse sphere are pressed into a block of tissue and slide along it; their
/// normals jump from triangle to triangle.
/// \returns the two cases, or an error of field::build_distance_field().
[[nodiscard]] Result<std::vector<ConvergenceCase>> synthetic_cases(Progress& progress);

struct ConvergenceOptions {
  std::filesystem::path output;  ///< Folder for the results; must exist.
  std::vector<ContactMethod> methods = contact_methods();
  double relative_tolerance = 1e-8;  ///< Of Newton's method, for all methods of contact.
  int max_iterations = 60;           ///< Of Newton's method in one increment, likewise.
};

/// Predicts each case by each method with the same mesh, increments and stopping criteria.
///
/// Writes convergence.csv (every Newton iteration), convergence.md (table; differences between
/// faces of one mesh after different numbers of steps), and for each case two plots, NAME-walk.svg
/// and NAME-first-step.svg, into the output folder. The files are written after every step, so that
/// a stopped run keeps its results.
/// \returns the table as Markdown; kFileUnwritable, kCancelled, or an error of predict_face().
[[nodiscard]] Result<std::string> run_convergence(std::span<const ConvergenceCase> cases,
                                                  const ConvergenceOptions& options,
                                                  Progress& progress);

}  // namespace lefort::bench
