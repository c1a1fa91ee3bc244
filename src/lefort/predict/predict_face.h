/// \file
/// The story: segments move, tissue is pushed or pulled along, and comes to rest at every step.
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/plan.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/predict/prediction_options.h>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace lefort::predict {

struct PredictionOptions {
  TissueOptions tissue;
  BoundaryOptions boundary;
  ContactOptions contact;
  SolverOptions solver;
};

/// Who tells how far the segment is.
///
/// A tree of boxes reaches as far as the field's band.
/// \returns as contact::field_distance_query().
[[nodiscard]] Result<std::shared_ptr<const contact::DistanceQuery>> detect_segment(
    const MovedSegment& segment, contact::DetectionMethod detection);

/// Whether contact with bones along these paths can be told by their detectors; nothing is asked of
/// them where tissue is attached.
///
/// \param paths  one a segment.
/// \returns nothing, or what detect_segment() returns, or
///   - kMeshInvalid      a surface is open: it has no inside;
///   - kInvalidArgument  boundary.capture_mm is not less than a detector's reach;
///   - kStepBeyondBand   a segment moves further from one load level to the next (steps and
///     keyframes of all) than its detector reaches.
[[nodiscard]] Result<void> check_reach(const std::vector<geometry::RigidPath>& paths,
                                       const std::vector<MovedSegment>& segments,
                                       contact::DetectionMethod detection,
                                       const BoundaryOptions& boundary);

/// k_c [MPa/mm] of a plan.
[[nodiscard]] double contact_stiffness_mpa_per_mm(const TissueOptions& tissue,
                                                  const ContactOptions& contact);

/// What a prediction has found so far and all that its next step depends on.
struct Restart {
  std::vector<PredictionStep> steps;  ///< Converged.
  fem::LoadStepper::Checkpoint stepper;
  std::vector<contact::ContactTerm::Checkpoint>
      contacts;  ///< One a segment, none if attached; still bone's.
};

/// Who watches a prediction; each may be empty.
struct PredictionWatch {
  std::function<void(const PredictionIterate&)> on_iterate{};  ///< Told each as it is found.
  std::function<void(const PredictionStep&)> on_step;          ///< Told each once it has converged.
  std::function<void(const Restart&)> on_restart;  ///< Likewise, with all there is to keep.
};

/// Follows the paths step by step, all segments moving together; each passes through every keyframe
/// of its own. There are as many steps as geometry::steps_of() says.
///
/// Between two steps no part of a segment moves further at once than a quarter of an element, nor
/// than half its detector's reach: the increments, not the steps, decide what is found.
/// \pre model.stationary_bone, where the tissue has a set sets::kStationaryContact.
/// \param paths    one for each of the model's segments.
/// \param earlier  where a run of the same model, paths and options was stopped; the rest of the
///   way is found with the same bits as without the stop.
/// \returns the steps that converged, and why it ended early if it did; or
///   - kPlanInvalid      a path cannot be followed (geometry::check_path);
///   - what check_reach() returns, and of still bone kMeshInvalid and kInvalidArgument likewise;
///   - kAnatomyMissing   no tissue lies on a segment, or nothing is fixed;
///   - kInvalidArgument  a material constant lies outside its range;
///   - kOutOfMemory      the tissue's mesh is too fine for this machine;
///   - kCancelled        `progress` asked to stop.
[[nodiscard]] Result<FacePrediction> predict_face(const FaceModel& model,
                                                  const std::vector<geometry::RigidPath>& paths,
                                                  const PredictionOptions& options,
                                                  const PredictionWatch& watch = {},
                                                  Progress& progress = Progress::none(),
                                                  std::optional<Restart> earlier = std::nullopt);

}  // namespace lefort::predict
