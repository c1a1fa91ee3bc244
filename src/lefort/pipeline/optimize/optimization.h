/// \file
/// All that the optimization of a plan has found, for its JSON and its report.
#pragma once

#include <lefort/inverse/optimize_motion.h>
#include <lefort/inverse/target_spec.h>
#include <lefort/pipeline/prepare/prepare_case.h>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace lefort::pipeline {

/// A target counts as reached up to this root mean square of its residuals: below it two faces are
/// not distinguished in comparisons of predicted and postoperative faces, whose errors are 1
/// mm and more (docs/guide/validate.md).
inline constexpr double kReached_mm = 0.5;

/// One target at the certified face.
struct TargetResult {
  std::string name;
  inverse::TargetResidual before;   ///< Of the face before surgery.
  inverse::TargetResidual reached;  ///< Of the certified face.
  bool is_reached = false;
  std::string reason;  ///< Why it is not; empty if it is.
};

struct Optimization {
  const PreparedCase& prepared;
  const inverse::TargetSpec& spec;
  std::string target_sha256;
  const inverse::FaceObserver& observer;
  const inverse::MotionVariables& variables;
  const inverse::MotionResult& result;
  double allowed_overlap_mm = 0.0;
  double coarse_element_size_mm = 0.0;
  std::vector<Vec3> certified_mm;  ///< Displacement of the skin by the full prediction.
  std::vector<inverse::Observation> certified;
  double start_objective = 0.0;  ///< Of the face before surgery.
};

/// \returns each target with the reason why it is not reached: bounds that the objective pushes
///   against, bone overlap, or what the model can reach.
[[nodiscard]] std::vector<TargetResult> target_results(const Optimization& done);

/// optimize.json (contract/optimize.schema.json), without the times.
[[nodiscard]] nlohmann::ordered_json optimize_json(const Optimization& done);

/// "midface roll 0.98, midface yaw 0.19": the numbers of a direction that matter.
[[nodiscard]] std::string describe(const inverse::MotionDirection& direction,
                                   const inverse::MotionVariables& variables);

}  // namespace lefort::pipeline
