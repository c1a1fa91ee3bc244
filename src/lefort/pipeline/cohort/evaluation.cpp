#include <lefort/core/version.h>
#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/cohort/evaluation.h>

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kEvaluationVersion = 1;
// Increase when results of the same inputs change.
constexpr const char* kRunRevision = "run-2";

std::string sorted_keys(const std::string& json) { return nlohmann::json::parse(json).dump(); }

Evaluation evaluation_of(const Json& json) {
  Evaluation one;
  one.participant = json.at("participant").get<std::string>();
  one.set = json.at("set").get<std::string>();
  one.overrides = json.at("overrides").dump();
  one.options_sha256 = json.at("options_sha256").get<std::string>();
  one.inputs_sha256 = json.at("inputs_sha256").get<std::string>();
  if (!json.at("failure").is_null()) one.failure = json.at("failure").get<std::string>();
  if (!json.at("skin").is_null()) {
    one.max_shift_mm = json.at("skin").at("max_shift_mm").get<double>();
    one.mean_shift_where_moved_mm = json.at("skin").at("mean_shift_where_moved_mm").get<double>();
  }
  one.comparison = case_result_of(json.at("comparison")).value();
  for (const auto& [name, file] : json.at("files").items())
    one.files[name] = {file.at("sha256").get<std::string>(),
                       file.at("bytes").get<std::uintmax_t>()};
  return one;
}

}  // namespace

std::string EvaluationPlace::name() const {
  return fmt::format("sub-{}, set {}", participant, set);
}

fs::path work_folder(const RunJob& job) { return job.work.value_or(job.output / ".lefort"); }

EvaluationPlace place_of(const RunJob& job, const std::string& participant,
                         const std::string& set) {
  const std::string case_folder = "sub-" + participant;
  const std::string stem = fmt::format("{}_set-{}", case_folder, set);
  return {.participant = participant,
          .set = set,
          .folder = job.output / case_folder / ("set-" + set),
          .partial = job.output / case_folder / (".partial-set-" + set),
          .log = job.output / "logs" / (stem + ".log"),
          .scratch = work_folder(job) / "scratch" / stem};
}

std::string options_key(const RunJob& job, const io::ParameterSet& set) {
  return io::Sha256()
      .add(kRunRevision)
      .add(kVersion)
      .add(sorted_keys(set.overrides))
      .add(job.achieved_movements ? 1.0 : 0.0)
      .add(job.voxel_mm)
      .add(job.pictures ? 1.0 : 0.0)
      .add(job.paraview ? 1.0 : 0.0)
      .hex();
}

Json as_json(const Evaluation& evaluation) {
  Json json{{"lefort_evaluation", kEvaluationVersion},
            {"notice", kNotForClinicalUse},
            {"version", kVersion},
            {"participant", evaluation.participant},
            {"set", evaluation.set},
            {"overrides", nlohmann::json::parse(evaluation.overrides)},
            {"options_sha256", evaluation.options_sha256},
            {"inputs_sha256", evaluation.inputs_sha256},
            {"outcome", evaluation.failure ? "failed" : "predicted"},
            {"failure", evaluation.failure ? Json(*evaluation.failure) : Json()},
            {"skin", Json()},
            {"comparison", as_json(evaluation.comparison)},
            {"files", Json::object()}};
  if (!evaluation.failure)
    json["skin"] = {{"max_shift_mm", evaluation.max_shift_mm},
                    {"mean_shift_where_moved_mm", evaluation.mean_shift_where_moved_mm}};
  for (const auto& [name, file] : evaluation.files)
    json["files"][name] = {{"sha256", file.sha256}, {"bytes", file.bytes}};
  return json;
}

Result<Evaluation> read_evaluation(const fs::path& file) {
  constexpr std::uintmax_t kMaxBytes = 16 << 20;
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxBytes));
  try {
    const Json json = Json::parse(text);
    if (json.at("lefort_evaluation") == kEvaluationVersion) return evaluation_of(json);
  } catch (const nlohmann::json::exception&) {  // Not such a file.
  } catch (const std::bad_optional_access&) {   // Neither is its comparison.
  }
  return fail(ErrorCode::kFileCorrupt, "evaluation.json is damaged");
}

bool has_files(const Evaluation& evaluation, const fs::path& folder) {
  return std::all_of(evaluation.files.begin(), evaluation.files.end(), [&](const auto& file) {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(folder / file.first, error);
    return !error && bytes == file.second.bytes;
  });
}

Result<std::map<std::string, FileDigest>> digest_files(const fs::path& folder) {
  std::map<std::string, FileDigest> files;
  std::error_code error;
  for (auto it = fs::recursive_directory_iterator(folder, error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (!it->is_regular_file(error)) continue;
    const std::string name = it->path().lexically_relative(folder).generic_string();
    if (name == "timing.json" || name == kEvaluationFile) continue;
    LEFORT_TRY(std::string sha256, io::sha256_of_file(it->path()));
    files[name] = {std::move(sha256), fs::file_size(it->path(), error)};
  }
  if (error)
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("the results cannot be read: {}", error.message()));
  return files;
}

}  // namespace lefort::pipeline
