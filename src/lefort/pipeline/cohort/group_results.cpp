#include <lefort/io/surface_files.h>
#include <lefort/pipeline/cohort/group_results.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using geometry::TriangleMesh;

/// The predicted skin of an evaluation; nothing if it is not predicted.
Result<std::optional<TriangleMesh>> read_skin(const RunJob& job, const GroupRow& row) {
  if (row.found.state != EvaluationState::kPredicted) return std::nullopt;
  const fs::path folder = place_of(job, row.participant, row.set).folder;
  LEFORT_TRY(TriangleMesh skin_L, io::read_surface(folder / "predicted_skin.vtp"));
  return skin_L;
}

std::optional<predict::SkinDisplacementStatistics> difference_of(const TriangleMesh& first_L,
                                                                 const TriangleMesh& other_L) {
  if (first_L.triangles != other_L.triangles) return std::nullopt;
  std::vector<Vec3> shift_mm;
  for (std::size_t v = 0; v < first_L.vertices.size(); ++v)
    shift_mm.push_back(other_L.vertices[v] - first_L.vertices[v]);
  return predict::measure_skin_displacement(shift_mm);
}

/// The evaluations of one case, compared with that of the first set.
Result<std::vector<GroupRow>> rows_of(const RunJob& job, const Participant& participant,
                                      const std::vector<io::ParameterSet>& sets) {
  std::vector<GroupRow> rows;
  for (const io::ParameterSet& set : sets)
    rows.push_back({participant.label, set.name, find_evaluation(job, participant, set)});
  if (rows.size() < 2) return rows;
  LEFORT_TRY(const auto first_L, read_skin(job, rows.front()));
  if (!first_L) return rows;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    LEFORT_TRY(const auto other_L, read_skin(job, rows[k]));
    if (other_L) rows[k].difference = difference_of(*first_L, *other_L);
  }
  return rows;
}

GroupSet statistics_of(const GroupResults& results, const io::ParameterSet& set) {
  GroupSet of_set{.set = set};
  std::vector<double> max_mm, mean_mm, max_difference_mm, mean_difference_mm;
  for (const GroupRow& row : results.rows) {
    if (row.set != set.name) continue;
    if (row.found.state == EvaluationState::kFailed) ++of_set.failed;
    if (row.found.state == EvaluationState::kMissing ||
        row.found.state == EvaluationState::kOutdated)
      ++of_set.missing;
    if (row.found.state != EvaluationState::kPredicted) continue;
    ++of_set.predicted;
    if (!row.found.evaluation.comparison.regions.empty()) ++of_set.compared;
    max_mm.push_back(row.found.evaluation.max_shift_mm);
    mean_mm.push_back(row.found.evaluation.mean_shift_where_moved_mm);
    if (!row.difference) continue;
    max_difference_mm.push_back(row.difference->max_mm);
    mean_difference_mm.push_back(row.difference->mean_over_moved_mm);
  }
  const auto value = [&](const std::vector<double>& values) {
    constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
    return values.empty() ? CohortValue{kNoNumber, {kNoNumber, kNoNumber}}
                          : cohort_value(values, results.bootstrap);
  };
  of_set.max_shift_mm = value(max_mm);
  of_set.mean_shift_mm = value(mean_mm);
  of_set.max_difference_mm = value(max_difference_mm);
  of_set.mean_difference_mm = value(mean_difference_mm);
  if (of_set.compared > 0)
    of_set.regions = cohort_statistics(cases_of(results, set.name), results.bootstrap);
  return of_set;
}

}  // namespace

Index GroupResults::count(EvaluationState state) const {
  return Index(std::count_if(rows.begin(), rows.end(),
                             [&](const GroupRow& row) { return row.found.state == state; }));
}

std::vector<CaseResult> cases_of(const GroupResults& results, const std::string& set) {
  std::vector<CaseResult> cases;
  for (const GroupRow& row : results.rows) {
    const bool is_compared = row.found.state == EvaluationState::kPredicted &&
                             !row.found.evaluation.comparison.regions.empty();
    if (row.set == set && (is_compared || row.found.state == EvaluationState::kFailed))
      cases.push_back(row.found.evaluation.comparison);
  }
  return cases;
}

Result<GroupResults> collect_group(const RunJob& job, Progress& progress) {
  LEFORT_TRY(CohortRun run, open_run(job));
  GroupResults results;
  progress.begin_stage("read the evaluations");
  for (std::size_t p = 0; p < run.participants.size(); ++p) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "stopped before the report was written");
    LEFORT_TRY(std::vector<GroupRow> rows, rows_of(job, run.participants[p], run.sets));
    std::move(rows.begin(), rows.end(), std::back_inserter(results.rows));
    progress.report(double(p + 1) / double(run.participants.size()));
  }
  results.participants = std::move(run.participants);
  for (const io::ParameterSet& set : run.sets) results.sets.push_back(statistics_of(results, set));
  return results;
}

}  // namespace lefort::pipeline
