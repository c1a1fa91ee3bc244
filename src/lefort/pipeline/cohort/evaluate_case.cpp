#include <lefort/core/version.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cohort/evaluate_case.h>
#include <lefort/pipeline/cohort/evaluation_log.h>
#include <lefort/pipeline/validate/run_case.h>

#include <fmt/format.h>

#include <new>
#include <system_error>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInputs = "inputs";
constexpr const char* kRestartEnding = "-steps.restart";

/// The evaluation that is computed.
struct Attempt {
  const RunJob& job;
  CaseInputs& inputs;
  const io::ParameterSet& set;
  EvaluationPlace place;

  /// Without folders and file names of the case.
  [[nodiscard]] std::string cleaned(std::string message) const {
    message = without_paths(std::move(message), place.partial / kInputs, place.partial);
    message = without_paths(std::move(message), work_folder(job), place.scratch);
    return without_paths(std::move(message), job.input, job.output);
  }
};

tl::unexpected<Error> unwritable(const std::error_code& error) {
  return fail(ErrorCode::kFileUnwritable,
              fmt::format("the results cannot be written: {}", error.message()));
}

/// Removes an outdated evaluation and what killed attempts left, except their converged steps.
Result<void> remove_leftovers(const EvaluationPlace& place) {
  std::error_code error;
  fs::remove(place.folder / kEvaluationFile, error);  // First: without it the rest is no result.
  for (const fs::path& folder : {place.folder, place.partial}) {
    fs::remove_all(folder, error);
    if (error) return unwritable(error);
  }
  for (fs::directory_iterator entry(place.scratch, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::error_code ignored;
    if (name.starts_with('.') || !name.ends_with(kRestartEnding))
      fs::remove_all(entry->path(), ignored);
  }
  return {};
}

CaseComputation computation_of(const Attempt& attempt) {
  const RunJob& job = attempt.job;
  const fs::path& partial = attempt.place.partial;
  const SharedCache shared{work_folder(job) / "cache", attempt.place.scratch};
  return {.setup = {.achieved_movements = job.achieved_movements,
                    .element_size_mm = std::nullopt,
                    .voxel_mm = job.voxel_mm,
                    .parameters = attempt.set,
                    .shared_cache = shared,
                    .link_inputs = true},
          .work = partial / kInputs,
          .pictures = partial / "pictures",
          .picture_prefix = "",
          .has_pictures = job.pictures,
          .predict = {.plan = {},
                      .ct = std::nullopt,
                      .output = partial,
                      .pictures = job.pictures,
                      .sensitivity = false,
                      .paraview = job.paraview,
                      .separate_timing = true,
                      .shared_cache = shared}};
}

/// Replaces the plan of the result, whose paths depend on the place of the input, by that with the
/// hashes of the files; removes the links to the inputs.
Result<void> remove_inputs(const fs::path& partial) {
  constexpr std::uintmax_t kMaxPlanBytes = 16 << 20;
  std::error_code error;
  if (fs::exists(partial / "plan.json", error)) {
    LEFORT_TRY(const std::string plan,
               io::read_text(partial / kInputs / "plan.json", kMaxPlanBytes));
    LEFORT_TRY_VOID(io::write_text(partial / "plan.json", plan));
  }
  fs::remove_all(partial / kInputs, error);
  return error ? Result<void>(unwritable(error)) : Result<void>();
}

/// Of a case that failed only the history of the solver is kept, if there is one.
Result<void> remove_unfinished(const fs::path& partial) {
  std::error_code error;
  if (fs::exists(partial / "failure.json", error)) return remove_inputs(partial);
  fs::remove_all(partial, error);
  return io::make_output_folder(partial);
}

Result<Evaluation> compute(const Attempt& attempt, Progress& progress) {
  Evaluation evaluation{.participant = attempt.place.participant,
                        .set = attempt.place.set,
                        .overrides = nlohmann::json::parse(attempt.set.overrides).dump(),
                        .options_sha256 = options_key(attempt.job, attempt.set),
                        .inputs_sha256 = attempt.inputs.sha256()};
  evaluation.comparison.name = attempt.place.participant;
  const auto computed = [&]() -> Result<ComputedCase> {
    const Result<CohortCase>& files = attempt.inputs.files();
    if (!files) return tl::unexpected(files.error());
    return predict_and_compare(*files, computation_of(attempt), evaluation.comparison, progress);
  }();
  if (computed) {
    evaluation.comparison = computed->result;
    const nlohmann::json& skin = computed->prediction.at("skin");
    evaluation.max_shift_mm = skin.at("max_shift_mm").get<double>();
    evaluation.mean_shift_where_moved_mm = skin.at("mean_shift_where_moved_mm").get<double>();
    LEFORT_TRY_VOID(remove_inputs(attempt.place.partial));
    return evaluation;
  }
  if (!is_of_case(computed.error())) return tl::unexpected(computed.error());
  evaluation.failure = attempt.cleaned(computed.error().message);
  evaluation.comparison.failure = evaluation.failure;
  LEFORT_TRY_VOID(remove_unfinished(attempt.place.partial));
  return evaluation;
}

/// Computes, writes evaluation.json last, and gives the folder its name.
Result<Evaluation> compute_and_publish(const Attempt& attempt, Progress& progress) {
  const EvaluationPlace& place = attempt.place;
  LEFORT_TRY_VOID(io::make_output_folder(place.partial));
  LEFORT_TRY(Evaluation evaluation, compute(attempt, progress));
  LEFORT_TRY(evaluation.files, digest_files(place.partial));
  LEFORT_TRY_VOID(
      io::write_text(place.partial / kEvaluationFile, as_json(evaluation).dump(1) + "\n"));
  std::error_code error;
  fs::rename(place.partial, place.folder, error);
  if (error) return unwritable(error);
  return evaluation;
}

Result<Evaluation> compute_within_memory(const Attempt& attempt, Progress& progress) {
  try {
    return compute_and_publish(attempt, progress);
  } catch (const std::bad_alloc&) {           // Reported below.
  } catch (const std::system_error& error) {  // A thread whose stack cannot be allocated.
    if (error.code() != std::errc::resource_unavailable_try_again) throw;
  }
  const auto& limit = attempt.job.memory_gb;
  return fail(ErrorCode::kOutOfMemory,
              limit ? fmt::format("there is not enough memory: --mem-gb is {:g}", *limit)
                    : std::string("there is not enough memory"));
}

std::optional<Evaluation> find_finished(const Attempt& attempt) {
  const fs::path& folder = attempt.place.folder;
  auto stored = read_evaluation(folder / kEvaluationFile);
  if (!stored || stored->options_sha256 != options_key(attempt.job, attempt.set) ||
      stored->inputs_sha256.empty() || stored->inputs_sha256 != attempt.inputs.sha256() ||
      !has_files(*stored, folder))
    return std::nullopt;
  return *std::move(stored);
}

}  // namespace

const Result<CohortCase>& CaseInputs::files() {
  read();
  return *files_;
}

const std::string& CaseInputs::sha256() {
  read();
  return sha256_;
}

void CaseInputs::read() {
  if (files_) return;
  files_ = find_case(participant_.folder, AfterSurgery::kOptional);
  if (!*files_) return;
  Result<std::string> sha256 = fingerprint_case(**files_);
  if (sha256)
    sha256_ = *std::move(sha256);
  else
    files_ = tl::unexpected(sha256.error());
}

Result<std::optional<Evaluated>> try_evaluate(const RunJob& job, CaseInputs& inputs,
                                              const io::ParameterSet& set, Progress& progress) {
  const Attempt attempt{job, inputs, set, place_of(job, inputs.participant().label, set.name)};
  const EvaluationPlace& place = attempt.place;
  std::error_code error;
  fs::create_directories(place.log.parent_path(), error);
  LEFORT_TRY(const std::optional<io::FileLock> lock, io::FileLock::try_lock(place.log));
  if (!lock) return std::nullopt;
  if (auto finished = find_finished(attempt)) return Evaluated{*std::move(finished), true};
  LEFORT_TRY_VOID(remove_leftovers(place));
  fs::create_directories(place.scratch, error);
  if (error) return unwritable(error);
  EvaluationLog log(
      *lock, place.name(),
      [&attempt](std::string text) { return attempt.cleaned(std::move(text)); }, progress);
  LEFORT_TRY_VOID(log.add(fmt::format("{} lefort {}", kLogStarted, kVersion)));
  Result<Evaluation> computed = compute_within_memory(attempt, log);
  if (!computed) {
    fs::remove_all(place.partial, error);
    static_cast<void>(log.add("stopped: " + computed.error().message));  // Of a full disk, too.
    return fail(computed.error().code,
                fmt::format("{}: {}", place.name(), attempt.cleaned(computed.error().message)));
  }
  LEFORT_TRY_VOID(
      log.add(fmt::format("{}: {}", kLogFinished, computed->failure.value_or("predicted"))));
  fs::remove_all(place.scratch, error);
  return Evaluated{*std::move(computed), false};
}

}  // namespace lefort::pipeline
