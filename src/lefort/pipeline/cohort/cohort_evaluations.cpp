#include <lefort/io/read_text.h>
#include <lefort/pipeline/cohort/cohort_evaluations.h>
#include <lefort/pipeline/cohort/evaluation_log.h>
#include <lefort/pipeline/validate/cohort_folder.h>
#include <lefort/pipeline/validate/find_cases.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "sub-";
constexpr const char* kDescription = "dataset_description.json";

tl::unexpected<Error> bad(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

bool is_letter_or_digit(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

std::string label_of(std::string_view name) {
  if (name.starts_with(kPrefix)) name.remove_prefix(kPrefix.size());
  std::string label;
  std::copy_if(name.begin(), name.end(), std::back_inserter(label), is_letter_or_digit);
  return label;
}

/// The keys that the BIDS standard requires of the description of a dataset.
Result<void> check_description(const fs::path& input) {
  constexpr std::uintmax_t kMaxBytes = 1 << 20;
  const auto invalid = [](const char* what) {
    return bad(
        fmt::format("the dataset {} {}: add the file of the BIDS standard, or give "
                    "--skip-bids-validation",
                    what, kDescription));
  };
  const auto text = io::read_text(input / kDescription, kMaxBytes);
  if (!text) return invalid("has no");
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  for (const char* key : {"Name", "BIDSVersion"})
    if (!json.is_object() || !json.contains(key) || !json[key].is_string())
      return invalid("lacks Name or BIDSVersion in");
  return {};
}

Result<std::vector<Participant>> list_participants(const fs::path& input) {
  LEFORT_TRY(const std::vector<fs::path> folders, list_cases(input));
  std::vector<Participant> all;
  for (const fs::path& folder : folders) {
    const std::string name = folder.filename().string();
    all.push_back({label_of(name), folder});
    if (all.back().label.empty())
      return bad(fmt::format("the folder {} has no letter or digit for a label: rename it", name));
    for (std::size_t k = 0; k + 1 < all.size(); ++k)
      if (all[k].label == all.back().label)
        return bad(fmt::format("the folders {} and {} have the same label {}: rename one",
                               all[k].folder.filename().string(), name, all[k].label));
  }
  return all;
}

Result<std::vector<Participant>> select_participants(std::vector<Participant> all,
                                                     const std::vector<std::string>& labels) {
  if (labels.empty()) return all;
  constexpr std::ptrdiff_t kListed = 20;
  std::set<std::string> wanted;
  std::vector<std::string> known;
  for (const std::string& label : labels) wanted.insert(label_of(label));
  for (const Participant& one : all) known.push_back(one.label);
  for (const std::string& label : wanted)
    if (std::find(known.begin(), known.end(), label) == known.end())
      return bad(fmt::format(
          "there is no participant {}; there are {}{}", label,
          fmt::join(known.begin(), known.begin() + std::min(kListed, std::ptrdiff_t(known.size())),
                    ", "),
          std::ptrdiff_t(known.size()) > kListed ? ", ..." : ""));
  std::erase_if(all, [&](const Participant& one) { return !wanted.contains(one.label); });
  return all;
}

}  // namespace

std::optional<std::string> repeated_label(const std::vector<std::string>& labels) {
  std::set<std::string> seen;
  for (const std::string& label : labels)
    if (!seen.insert(label_of(label)).second) return label;
  return std::nullopt;
}

Result<CohortRun> open_run(const RunJob& job) {
  CohortRun run;
  LEFORT_TRY(run.participants, list_participants(job.input));
  const bool is_bids = is_bids_dataset(job.input);
  if (is_bids && !job.skip_bids_validation) LEFORT_TRY_VOID(check_description(job.input));
  if (is_inside(job.input, job.output) || (!is_bids && is_inside(job.output, job.input)))
    return bad(fmt::format("the output {} and the input contain one another, must be other folders",
                           job.output.string()));
  LEFORT_TRY(run.participants, select_participants(std::move(run.participants), job.participants));
  std::vector<io::ParameterSet> all{io::default_set()};
  if (job.parameters) {
    LEFORT_TRY(all, io::read_parameter_sets(*job.parameters));
  }
  LEFORT_TRY(run.sets, io::select_sets(std::move(all), job.sets));
  return run;
}

const char* name_of(EvaluationState state) {
  switch (state) {
    case EvaluationState::kPredicted:
      return "predicted";
    case EvaluationState::kFailed:
      return "failed";
    case EvaluationState::kOutdated:
      return "outdated";
    case EvaluationState::kMissing:
      break;
  }
  return "missing";
}

FoundEvaluation find_evaluation(const RunJob& job, const Participant& participant,
                                const io::ParameterSet& set) {
  const EvaluationPlace place = place_of(job, participant.label, set.name);
  FoundEvaluation found;
  auto stored = read_evaluation(place.folder / kEvaluationFile);
  if (!stored) {
    const int attempts = attempts_in(place.log);
    found.reason = attempts == 0   ? "not started"
                   : attempts == 1 ? "started once, not finished"
                                   : fmt::format("started {} times, not finished", attempts);
    return found;
  }
  found.evaluation = *std::move(stored);
  if (found.evaluation.options_sha256 != options_key(job, set)) {
    found.state = EvaluationState::kOutdated;
    found.reason = "computed with another version, parameter set or option";
  } else if (found.evaluation.failure) {
    found.state = EvaluationState::kFailed;
    found.reason = *found.evaluation.failure;
  } else if (!has_files(found.evaluation, place.folder)) {
    found.state = EvaluationState::kOutdated;
    found.reason = "files of the result are missing or have another size";
  } else {
    found.state = EvaluationState::kPredicted;
  }
  return found;
}

}  // namespace lefort::pipeline
