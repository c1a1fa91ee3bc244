/// \file
/// Result of a prediction: one state for each step along the paths. A value.
#pragma once

#include <lefort/contact/contact_statistics.h>
#include <lefort/contact/support_term.h>
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
  contact::ContactStatistics contact;   ///< Of the tissue with the segment; zero with kBonded.
  contact::SupportStatistics supports;  ///< Of elevated and sliding tissue on it.
};

/// The equilibrium at one step.
struct PredictionStep {
  double path_fraction = 0.0;         ///< 0 to 1.
  std::vector<SegmentStep> segments;  ///< In the order of the plan.
  std::vector<Vec3> displacement_mm;  ///< One per node of the tissue.
  /// Of tissue with stationary bone; zero without such tissue.
  contact::ContactStatistics stationary_contact = {};
  contact::SupportStatistics stationary_supports = {};  ///< Of elevated and sliding tissue on it.
  double min_J = 1.0;                                   ///< Min Jacobian of the elements; positive.
  double residual_n = 0.0;                              ///< Norm of the residual, last iteration.
  double relative_residual = 0.0;          ///< To the residual reference (fem/assembly/assemble.h).
  std::vector<fem::LoadAttempt> attempts;  ///< Since the step before.

  /// Contact with all segments. Tissue that touches two segments counts for both. The 99th
  /// percentile is the max of the segments', an upper bound of that of all tissue in contact.
  [[nodiscard]] contact::ContactStatistics contact() const;
  /// The same with the segments and stationary bone.
  [[nodiscard]] contact::ContactStatistics contact_of_all_bones() const {
    return contact::combine(contact(), stationary_contact);
  }

  /// Of all attempts.
  [[nodiscard]] Index newton_iterations() const {
    Index count = 0;
    for (const fem::LoadAttempt& attempt : attempts)
      count += std::max<Index>(Index(attempt.history.size()) - 1, 0);
    return count;
  }
};

/// One Newton iteration of the step being solved.
struct PredictionIterate {
  double to_fraction = 0.0;  ///< Path fraction at which equilibrium is sought.
  int attempt = 1;           ///< Of this step, from 1, as PredictionStep::attempts.
  int iteration = 0;         ///< Of this attempt; 0 is the start.
  fem::NewtonIterate line;
  double deepest_mm = 0.0;  ///< Largest penetration increase of tissue in contact.
};

struct FacePrediction {
  double contact_stiffness_mpa_per_mm = 0.0;      ///< k_c; 0 without contact.
  double rest_penetration_mm = 0.0;               ///< Of the tissue into segments at rest.
  std::vector<PredictionStep> steps;              ///< Converged ones; all, unless it failed.
  std::optional<Error> failure;                   ///< Why the end of the path was not reached.
  std::vector<fem::LoadAttempt> failed_attempts;  ///< After the last converged step.
  /// Of the nodes of set `contact` after the last step, for each segment; empty with kBonded, or if
  /// the end of the path was not reached.
  std::vector<std::vector<contact::NodalContact>> nodal_contacts;

  [[nodiscard]] bool converged() const { return !failure.has_value(); }
};

}  // namespace lefort::predict
