/// \file
/// Statistics of a cohort for each parameter set. Reads evaluations, writes nothing.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/parameter_sets.h>
#include <lefort/pipeline/cohort/cohort_evaluations.h>
#include <lefort/pipeline/run.h>
#include <lefort/pipeline/validate/cohort_statistics.h>
#include <lefort/predict/skin_displacement.h>

#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// One evaluation in the results of the group.
struct GroupRow {
  std::string participant, set;
  FoundEvaluation found;
  /// Distance of each skin vertex from its place with the first set; none for the first set, if one
  /// of both is not predicted, or if the skins have other triangles.
  std::optional<predict::SkinDisplacementStatistics> difference{};
};

/// All cases with one parameter set.
struct GroupSet {
  io::ParameterSet set;
  Index predicted = 0, failed = 0, missing = 0;  ///< `missing` with those that are outdated.
  Index compared = 0;                            ///< With a face after surgery.
  CohortValue max_shift_mm{}, mean_shift_mm{};   ///< Of the skin.
  CohortValue max_difference_mm{}, mean_difference_mm{};  ///< GroupRow::difference.
  std::vector<CohortRegion> regions{};                    ///< Of the cases that are compared.
};

struct GroupResults {
  std::vector<Participant> participants;
  std::vector<GroupRow> rows;  ///< By participant, then by set.
  std::vector<GroupSet> sets;
  compare::BootstrapOptions bootstrap{};

  [[nodiscard]] Index count(EvaluationState state) const;
};

/// \returns the results; kCancelled; or the errors of open_run() and of reading a predicted skin.
[[nodiscard]] Result<GroupResults> collect_group(const RunJob& job, Progress& progress);

/// The results of the cases that are compared or failed with one set, for cohort_statistics().
[[nodiscard]] std::vector<CaseResult> cases_of(const GroupResults& results, const std::string& set);

}  // namespace lefort::pipeline
