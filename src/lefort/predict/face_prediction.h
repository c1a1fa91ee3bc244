/// \file
/// What a prediction found, step by step along the bones' paths. A value.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/solve/load_steps.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace lefort::predict {

/// One segment at a step.
struct SegmentStep {
  RigidTransform X_LB;
  contact::ContactStatistics contact;  ///< Of the tissue with it; zero where tissue is attached.
};

/// The equilibrium at one of the asked-for moments of the path.
struct PredictionStep {
  double path_fraction = 0.0;         ///< Of the path, 0 to 1.
  std::vector<SegmentStep> segments;  ///< In the order of the plan.
  std::vector<Vec3> displacement_mm;  ///< One per node of the tissue.
  /// Of the tissue that slides on still bone; zero unless some is painted so.
  contact::ContactStatistics stationary_contact = {};
  double min_J = 1.0;                      ///< Least volume ratio of an element; positive.
  double residual_n = 0.0;                 ///< Of the unbalanced forces, last iteration.
  double relative_residual = 0.0;          ///< To the forces that cancel (fem/assembly/assemble.h).
  std::vector<fem::LoadAttempt> attempts;  ///< All that was tried to come here.

  /// With all segments. Tissue that touches two counts for both; the P99 is that of the segment
  /// where it is largest, so that of all tissue in contact is no larger.
  [[nodiscard]] contact::ContactStatistics contact() const;

  /// Of all attempts.
  [[nodiscard]] Index newton_iterations() const {
    Index count = 0;
    for (const fem::LoadAttempt& attempt : attempts)
      count += std::max<Index>(Index(attempt.history.size()) - 1, 0);
    return count;
  }
};

/// A line of Newton's history while its step is being sought.
struct PredictionIterate {
  double to_fraction = 0.0;  ///< Of the path: where equilibrium is sought.
  int attempt = 1;           ///< Of this step, as PredictionStep::attempts counts them, from 1.
  int iteration = 0;         ///< Of this attempt; 0 is its start.
  fem::NewtonIterate line;
  double deepest_mm = 0.0;  ///< How much deeper than at rest tissue in contact lies, at most.
};

struct FacePrediction {
  double contact_stiffness_mpa_per_mm = 0.0;  ///< k_c; 0 where tissue is attached.
  double rest_penetration_mm = 0.0;   ///< Of the tissue's mesh into segments before they move.
  std::vector<PredictionStep> steps;  ///< Converged ones alone; all of them if nothing failed.
  std::optional<Error> failure;       ///< Why the path was not followed to its end.
  std::vector<fem::LoadAttempt> failed_attempts;  ///< After the last converged step.
  /// Of the nodes of set `contact` after the last step, for each segment; empty if tissue is
  /// attached or the path was not followed to its end.
  std::vector<std::vector<contact::NodalContact>> touched;

  [[nodiscard]] bool converged() const { return !failure.has_value(); }
};

}  // namespace lefort::predict
