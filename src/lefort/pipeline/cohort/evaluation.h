/// \file
/// The result of one case with one parameter set, as stored.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/parameter_sets.h>
#include <lefort/pipeline/run.h>
#include <lefort/pipeline/validate/case_result.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace lefort::pipeline {

/// Name of the file that is written last: its presence shows that the evaluation is finished.
inline constexpr const char* kEvaluationFile = "evaluation.json";

/// Where the files of an evaluation are.
struct EvaluationPlace {
  std::string participant, set;
  std::filesystem::path folder;   ///< OUTPUT/sub-LABEL/set-NAME; has kEvaluationFile if finished.
  std::filesystem::path partial;  ///< Beside it, while it is computed.
  std::filesystem::path log;      ///< Also its lock.
  std::filesystem::path scratch;  ///< Below the work folder.

  /// "sub-01, set default", for messages.
  [[nodiscard]] std::string name() const;
};

[[nodiscard]] EvaluationPlace place_of(const RunJob& job, const std::string& participant,
                                       const std::string& set);

/// The folder of unfinished predictions and of the cache.
[[nodiscard]] std::filesystem::path work_folder(const RunJob& job);

struct FileDigest {
  std::string sha256;
  std::uintmax_t bytes = 0;
};

struct Evaluation {
  std::string participant, set;
  std::string overrides;       ///< Of the set: JSON with sorted keys.
  std::string options_sha256;  ///< Of set, options and version.
  std::string inputs_sha256;   ///< Of the files of the case.
  std::optional<std::string> failure{};
  double max_shift_mm = 0.0, mean_shift_where_moved_mm = 0.0;  ///< Of the skin.
  CaseResult comparison{};                    ///< Regions only with a face after surgery.
  std::map<std::string, FileDigest> files{};  ///< By name; not timing.json and evaluation.json.
};

/// Hash of all that changes the results of an evaluation, except the files of its case.
[[nodiscard]] std::string options_key(const RunJob& job, const io::ParameterSet& set);

[[nodiscard]] nlohmann::ordered_json as_json(const Evaluation& evaluation);

/// \returns the evaluation; kFileNotFound; or kFileCorrupt if the file is not one of as_json().
[[nodiscard]] Result<Evaluation> read_evaluation(const std::filesystem::path& file);

/// Whether all files of a finished evaluation exist with their sizes.
[[nodiscard]] bool has_files(const Evaluation& evaluation, const std::filesystem::path& folder);

/// Hashes the files of a folder, except timing.json and kEvaluationFile.
[[nodiscard]] Result<std::map<std::string, FileDigest>> digest_files(
    const std::filesystem::path& folder);

}  // namespace lefort::pipeline
