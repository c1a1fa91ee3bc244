/// \file
/// How the face answers a small motion of the segment: a preview while a bone is being dragged, not
/// a prediction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/prediction_options.h>

#include <array>
#include <span>
#include <vector>

namespace lefort::predict {

/// The displacement of points under any motion of the segment, to first order.
///
/// A rigid motion moves the point X of the bone by t + A (X - centre) with A = R - I: by twelve
/// numbers, of which the answer is a linear function.
struct LinearResponse {
  Vec3 centre_B = Vec3::Zero();
  /// Of every point, per mm of t along x, y, z, then per unit of A, row by row.
  std::array<std::vector<Vec3>, 12> unit_mm;
};

/// Solves small-strain elasticity with the tissue's stiffness at rest: tissue on
/// the segment goes with it, all else is held as in a prediction. Contact is not solved, so that
/// tissue neither slides on the bone nor comes off it.
///
/// \returns the response of the tissue's nodes; what predict_face() returns for a model without
///   tissue on bone; kNotConverged or kOutOfMemory if the equations cannot be solved; kCancelled.
/// \note Costs one factorisation and twelve solutions.
[[nodiscard]] Result<LinearResponse> solve_linear_response(const FaceModel& model,
                                                           const TissueOptions& tissue,
                                                           Progress& progress = Progress::none());

/// The answer to a pose.
///
/// \param X_LB  of the segment.
/// \returns one displacement per point [mm].
/// \note Exact for the equations that were solved; how far they are from a prediction grows with
///   the motion (docs/planner.md).
[[nodiscard]] std::vector<Vec3> displacement_at(const LinearResponse& response,
                                                const RigidTransform& X_LB);

}  // namespace lefort::predict
