/// \file
/// Prediction of the face: segments follow their paths, and the tissue is in equilibrium at every
/// step.
#pragma once

#include <lefort/contact/contact_statistics.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/plan.h>
#include <lefort/predict/check_query_range.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/predict/prediction_options.h>

#include <functional>
#include <optional>
#include <vector>

namespace lefort::predict {

struct PredictionOptions {
  TissueOptions tissue;
  BoundaryOptions boundary;
  ContactOptions contact;
  SolverOptions solver;
};

/// The steps found so far and all that the next step depends on.
struct Restart {
  std::vector<PredictionStep> steps;  ///< Converged.
  fem::LoadStepper::Checkpoint stepper;
};

/// Callbacks of a prediction; each may be empty.
struct PredictionWatch {
  std::function<void(const PredictionIterate&)> on_iterate{};  ///< After each Newton iteration.
  std::function<void(const PredictionStep&)> on_step;          ///< After on_restart.
  std::function<void(const Restart&)> on_restart;              ///< After each converged step.
};

/// Moves all segments together along their paths and finds equilibrium at each of the
/// geometry::steps_of() steps; each segment passes through all its keyframes.
///
/// A step is divided into increments, see increments_of_step(). The result depends on the
/// increments, not on the steps.
/// \pre model.stationary_bone, if needed (FaceModel::stationary_bone).
/// \param model     tissue at rest with its sets, and the bones.
/// \param paths     one for each of the model's segments.
/// \param options   materials, boundary, contact and solver.
/// \param watch     is called as states are found.
/// \param progress  reports the path fraction; may stop the prediction.
/// \param earlier   where a run of the same model, paths and options stopped. The remaining steps
///   have the same bits as without the stop.
/// \returns the steps that converged, and why it ended early if it did; or
///   - kPlanInvalid      a path cannot be followed (geometry::check_path);
///   - what bone_distance_queries(), check_query_range(), check_stationary_bone() and
///     fem::make_element_terms() return;
///   - kAnatomyMissing   no tissue lies on a segment, or nothing is fixed;
///   - kInvalidArgument  a material constant lies outside its range;
///   - kOutOfMemory      the tissue mesh is too fine for the memory of this machine;
///   - kCancelled        `progress` requested the stop.
[[nodiscard]] Result<FacePrediction> predict_face(const FaceModel& model,
                                                  const std::vector<geometry::RigidPath>& paths,
                                                  const PredictionOptions& options,
                                                  const PredictionWatch& watch = {},
                                                  Progress& progress = Progress::none(),
                                                  std::optional<Restart> earlier = std::nullopt);

}  // namespace lefort::predict
