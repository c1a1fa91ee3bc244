/// \file
/// The story: the segment moves, tissue is pushed or pulled along, and comes to rest at every step.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/plan/plan.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/predict/prediction_options.h>

#include <functional>
#include <memory>

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

/// Whether contact with a bone along this path can be told by its field; nothing is asked of it
/// where tissue is attached.
///
/// \returns nothing, or
///   - kMeshInvalid      the field is that of an open surface: it has no inside;
///   - kInvalidArgument  boundary.capture_mm is not less than the field's band;
///   - kStepBeyondBand   the segment moves further from one load level to the next (steps and
///     keyframes) than its field reaches.
[[nodiscard]] Result<void> check_field_reach(const plan::BonePath& path,
                                             const geometry::TriangleMesh& segment_B,
                                             const field::DistanceField& field_B,
                                             const BoundaryOptions& boundary);

/// Follows the path step by step; the bone passes through every keyframe between.
///
/// \param on_step  is told each step once it has converged; may be empty.
/// \returns the steps that converged, and why it ended early if it did; or
///   - kPlanInvalid      the path cannot be followed (plan::check_path);
///   - what check_field_reach() returns;
///   - kAnatomyMissing   no tissue lies on the segment, or nothing is fixed;
///   - kInvalidArgument  a material constant lies outside its range;
///   - kOutOfMemory      the tissue's mesh is too fine for this machine;
///   - kCancelled        `progress` asked to stop.
[[nodiscard]] Result<FacePrediction> predict_face(
    const FaceModel& model, const plan::BonePath& path, const PredictionOptions& options,
    const std::function<void(const PredictionStep&)>& on_step = {},
    Progress& progress = Progress::none());

}  // namespace lefort::predict
