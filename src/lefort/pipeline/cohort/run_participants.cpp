#include <lefort/core/version.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cohort/cohort_evaluations.h>
#include <lefort/pipeline/cohort/evaluate_case.h>
#include <lefort/pipeline/cohort/memory_limit.h>
#include <lefort/pipeline/run.h>
#include <lefort/pipeline/validate/run_case.h>

#include <fmt/format.h>

#include <chrono>
#include <thread>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// An evaluation to compute: a case and a parameter set.
struct Pending {
  CaseInputs* inputs;
  const io::ParameterSet* set;
};

/// What became of the evaluations.
struct Totals {
  std::size_t all = 0, predicted = 0, reused = 0, failed = 0;
  std::optional<Error> first_failure{};
  Json evaluations = Json::array();

  [[nodiscard]] std::size_t tried() const { return predicted + failed; }
  void add_failure(const Error& error) {
    ++failed;
    if (!first_failure) first_failure = error;
  }
};

/// Whether the rest of the run would fail for the same reason.
bool is_of_run(const Error& error) {
  return error.code == ErrorCode::kCancelled || error.code == ErrorCode::kFileUnwritable;
}

void count(const Evaluated& done, Progress& progress, Totals& totals) {
  const Evaluation& one = done.evaluation;
  if (done.is_reused) ++totals.reused;
  totals.evaluations.push_back({{"participant", one.participant},
                                {"set", one.set},
                                {"state", one.failure ? "failed" : "predicted"},
                                {"reused", done.is_reused}});
  if (!one.failure) {
    ++totals.predicted;
    return;
  }
  const std::string reason =
      fmt::format("sub-{}, set {}: failed: {}", one.participant, one.set, *one.failure);
  progress.note(reason);
  totals.add_failure({ErrorCode::kNotConverged, reason});
}

tl::unexpected<Error> cancelled(const Totals& totals) {
  return fail(ErrorCode::kCancelled,
              fmt::format("stopped after {} of {} evaluations; the same command resumes",
                          totals.tried(), totals.all));
}

/// Tries each evaluation.
///
/// \returns those that other processes compute; or the error that ends the run.
Result<std::vector<Pending>> try_all(const RunJob& job, const std::vector<Pending>& pending,
                                     Totals& totals, Progress& progress) {
  std::vector<Pending> locked;
  for (const Pending& one : pending) {
    if (progress.stop_requested()) return cancelled(totals);
    auto tried = try_evaluate(job, *one.inputs, *one.set, progress);
    if (!tried && tried.error().code == ErrorCode::kCancelled) return cancelled(totals);
    if (!tried && is_of_run(tried.error())) return tl::unexpected(tried.error());
    if (!tried) {
      progress.note(tried.error().message);
      totals.add_failure(tried.error());
    } else if (*tried) {
      count(**tried, progress, totals);
    } else {
      locked.push_back(one);
    }
  }
  return locked;
}

/// Tries all until no other process computes one of them. Another process may be killed: its
/// evaluation is then computed here.
Result<void> evaluate_all(const RunJob& job, std::vector<Pending> pending, Totals& totals,
                          Progress& progress) {
  constexpr auto kPause = std::chrono::milliseconds(300);
  bool is_noted = false;
  while (!pending.empty()) {
    LEFORT_TRY(std::vector<Pending> locked, try_all(job, pending, totals, progress));
    if (locked.size() == pending.size()) {
      if (!is_noted)
        progress.note(
            fmt::format("{} evaluations are computed by other processes: waiting", locked.size()));
      is_noted = true;
      std::this_thread::sleep_for(kPause);
    }
    pending = std::move(locked);
  }
  return {};
}

/// The description of the output as a BIDS derivative.
Result<void> describe_dataset(const fs::path& output) {
  const Json json{
      {"Name", "Faces predicted by lefort"},
      {"BIDSVersion", "1.8.0"},
      {"DatasetType", "derivative"},
      {"GeneratedBy",
       Json::array(
           {{{"Name", "lefort"}, {"Version", kVersion}, {"Description", kNotForClinicalUse}}})}};
  return io::write_text(output / "dataset_description.json", json.dump(2) + "\n");
}

Result<Summary> summarize(const RunJob& job, Totals totals) {
  if (totals.failed > 0) {
    const Error& first = *totals.first_failure;
    return fail(first.code,
                fmt::format("{} of {} evaluations failed, the others are finished; {}{}",
                            totals.failed, totals.all, first.message,
                            totals.failed > 1 ? " (the level `group` lists all)" : ""));
  }
  Summary summary;
  summary.text =
      fmt::format("{}: {} evaluations predicted, {} of them by earlier runs or other processes",
                  job.output.string(), totals.predicted, totals.reused);
  summary.json = {{"lefort_run", 1},
                  {"notice", kNotForClinicalUse},
                  {"version", kVersion},
                  {"evaluations", std::move(totals.evaluations)}};
  return summary;
}

}  // namespace

Result<Summary> run_participants(const RunJob& job, Progress& progress) {
  LEFORT_TRY(const CohortRun run, open_run(job));
  if (job.memory_gb) LEFORT_TRY_VOID(limit_memory(*job.memory_gb));
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(io::make_output_folder(work_folder(job)));
  LEFORT_TRY_VOID(describe_dataset(job.output));
  std::vector<CaseInputs> inputs;
  for (const Participant& participant : run.participants) inputs.emplace_back(participant);
  std::vector<Pending> pending;
  for (CaseInputs& one : inputs)
    for (const io::ParameterSet& set : run.sets) pending.push_back({&one, &set});
  Totals totals;
  totals.all = pending.size();
  LEFORT_TRY_VOID(evaluate_all(job, std::move(pending), totals, progress));
  return summarize(job, std::move(totals));
}

Result<Summary> list_evaluations(const RunJob& job) {
  LEFORT_TRY(const CohortRun run, open_run(job));
  Json list = Json::array();
  std::string text;
  std::array<std::size_t, 4> counts{};
  for (const Participant& participant : run.participants) {
    Json files = Json::array();
    const auto add = [&](const fs::path& path) {
      files.push_back(path.lexically_normal()
                          .lexically_relative(job.input.lexically_normal())
                          .generic_string());
    };
    if (const auto one = find_case(participant.folder, AfterSurgery::kOptional)) {
      for (const auto& [role, path] : one->inputs()) add(path);
      for (const fs::path& path : files_of_plan(*one)) add(path);
    }
    for (const io::ParameterSet& set : run.sets) {
      const FoundEvaluation found = find_evaluation(job, participant, set);
      ++counts[std::size_t(found.state)];
      list.push_back({{"participant", participant.label},
                      {"set", set.name},
                      {"state", name_of(found.state)},
                      {"reason", found.reason},
                      {"files", files}});
      if (found.state != EvaluationState::kPredicted)
        text += fmt::format("\n  sub-{}, set {}: {}: {}", participant.label, set.name,
                            name_of(found.state), found.reason);
    }
  }
  Summary summary;
  summary.text = fmt::format("{} evaluations: {} predicted, {} failed, {} outdated, {} missing{}",
                             list.size(), counts[0], counts[1], counts[2], counts[3], text);
  summary.json = {{"lefort_run", 1},
                  {"notice", kNotForClinicalUse},
                  {"version", kVersion},
                  {"evaluations", std::move(list)}};
  return summary;
}

}  // namespace lefort::pipeline
