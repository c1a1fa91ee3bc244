/// \file
/// The story: the segment moves, tissue is pushed or pulled along, and comes to rest at every step.
#pragma once

#include <lefort/contact/detector.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/fem/load_steps.h>
#include <lefort/field/distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/plan/plan.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/predict/prediction_options.h>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace lefort::predict {

/// All that is there before anything moves.
struct FaceModel {
  mesh::VolumeMesh tissue;  ///< With the sets of tissue_boundary.h.
  geometry::TriangleMesh segment_B;
  std::shared_ptr<const field::DistanceField> segment_field_B;
};

struct PredictionOptions {
  TissueOptions tissue;
  BoundaryOptions boundary;
  ContactOptions contact;
  SolverOptions solver;
};

/// Who tells how far the segment is.
///
/// \param field_B  of the segment; a tree of boxes reaches as far as its band.
/// \returns as contact::detect_by_field().
[[nodiscard]] Result<std::shared_ptr<const contact::Detector>> detect_segment(
    const geometry::TriangleMesh& segment_B,
    const std::shared_ptr<const field::DistanceField>& field_B, contact::Detection detection);

/// Whether contact with a bone along this path can be told by its detector; nothing is asked of it
/// where tissue is attached.
///
/// \returns nothing, or
///   - kMeshInvalid      the surface is open: it has no inside;
///   - kInvalidArgument  boundary.capture_mm is not less than the detector's reach;
///   - kStepBeyondBand   the segment moves further from one load level to the next (steps and
///     keyframes) than the detector reaches.
[[nodiscard]] Result<void> check_reach(const plan::BonePath& path,
                                       const geometry::TriangleMesh& segment_B,
                                       const contact::Detector& detector_B,
                                       const BoundaryOptions& boundary);

/// k_c [MPa/mm] of a plan.
[[nodiscard]] double contact_stiffness_mpa_per_mm(const TissueOptions& tissue,
                                                  const ContactOptions& contact);

/// What a prediction has found so far and all that its next step depends on.
struct Restart {
  std::vector<PredictionStep> steps;  ///< Converged.
  fem::LoadStepper::Memory stepper;
  std::vector<contact::ContactTerm::Memory> contacts;
};

/// Who watches a prediction; each may be empty.
struct PredictionWatch {
  std::function<void(const PredictionIterate&)> on_iterate{};  ///< Told each as it is found.
  std::function<void(const PredictionStep&)> on_step;          ///< Told each once it has converged.
  std::function<void(const Restart&)> on_restart;  ///< Likewise, with all there is to keep.
};

/// Follows the path step by step; the bone passes through every keyframe between.
///
/// Between two steps no part of the segment moves further at once than a quarter of an element,
/// nor than half its detector's reach: the increments, not the steps, decide what is found.
/// \param earlier  where a run of the same model, path and options was stopped; the rest of the
///   way is found with the same bits as without the stop.
/// \returns the steps that converged, and why it ended early if it did; or
///   - kPlanInvalid      the path cannot be followed (plan::check_path);
///   - what detect_segment() and check_reach() return;
///   - kAnatomyMissing   no tissue lies on the segment, or nothing is fixed;
///   - kInvalidArgument  a material constant lies outside its range;
///   - kOutOfMemory      the tissue's mesh is too fine for this machine;
///   - kCancelled        `progress` asked to stop.
[[nodiscard]] Result<FacePrediction> predict_face(const FaceModel& model,
                                                  const plan::BonePath& path,
                                                  const PredictionOptions& options,
                                                  const PredictionWatch& watch = {},
                                                  Progress& progress = Progress::none(),
                                                  std::optional<Restart> earlier = std::nullopt);

}  // namespace lefort::predict
