/// \file
/// `lefort run`, as users and jobs of a cluster run it.
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/result_file.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

extern char** environ;

namespace lefort::app::test_run_command {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

std::string text_of(const fs::path& file) {
  return io::read_text(file, 1 << 28).value_or("missing");
}

/// A cohort of two coarse synthetic cases, and two parameter sets, made once.
struct Cohort {
  test::TemporaryFolder folder;
  fs::path path, sets;
};

const Cohort& cohort() {
  static const Cohort* const made = [] {
    static Cohort one;
    one.path = one.folder / "cohort";
    one.sets = one.folder / "sets.json";
    const auto run = test::run_lefort("phantom --cohort 2 --voxel 4 --element-size 10 --quiet -o " +
                                      quoted(one.path));
    EXPECT_EQ(run.exit_code, 0) << run.error;
    EXPECT_TRUE(io::write_text(one.sets, R"({"lefort_parameter_sets": 1, "sets": {
      "default": {}, "stiff": {"tissue": {"material": {"law": "neo-hookean", "young_kpa": 15, "poisson": 0.47}}}}})"));
    return &one;
  }();
  return *made;
}

/// Arguments of a run of all evaluations without pictures.
std::string run_all(const fs::path& output, const std::string& level = "participant") {
  return fmt::format("run {} {} {} --parameters {} --no-pictures", quoted(cohort().path),
                     quoted(output), level, quoted(cohort().sets));
}

/// The result of all evaluations in one process, made once.
const fs::path& finished() {
  static const test::TemporaryFolder folder;
  static const fs::path output = [] {
    for (const char* level : {"participant", "group"}) {
      const auto run = test::run_lefort(run_all(folder / "out", level) + " --quiet");
      EXPECT_EQ(run.exit_code, 0) << run.error;
    }
    return folder / "out";
  }();
  return output;
}

/// Bytes of all results. Logs, the work folder, times and memory differ between runs.
std::map<std::string, std::string> results_of(const fs::path& output) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(output)) {
    const std::string name = entry.path().lexically_relative(output).generic_string();
    if (!entry.is_regular_file() || name.starts_with("logs/") || name.starts_with(".lefort/") ||
        name.ends_with("timing.json"))
      continue;
    files[name] = text_of(entry.path());
  }
  return files;
}

void expect_equal_results(const fs::path& one, const fs::path& other) {
  const auto expected = results_of(one), found = results_of(other);
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_EQ(bytes == found.at(name), true) << name << " differs";
  }
  EXPECT_EQ(expected.size(), found.size());
}

int lines_with(const fs::path& log, const std::string& word) {
  std::istringstream lines(text_of(log));
  int count = 0;
  for (std::string line; std::getline(lines, line);)
    if (line.find(" " + word) != std::string::npos) ++count;
  return count;
}

/// A program in the background.
class Background {
 public:
  explicit Background(const std::string& arguments) {
    std::string command = "exec '" LEFORT_PROGRAM "' " + arguments + " --quiet 2>/dev/null";
    std::string shell = "/bin/bash", option = "-c";
    std::array<char*, 4> texts{shell.data(), option.data(), command.data(), nullptr};
    EXPECT_EQ(::posix_spawn(&process_, "/bin/bash", nullptr, nullptr, texts.data(), environ), 0);
  }
  ~Background() {
    if (!is_running()) return;
    ::kill(process_, SIGKILL);
    wait();
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  [[nodiscard]] bool is_running() {
    if (!has_ended_ && ::waitpid(process_, &status_, WNOHANG) != 0) has_ended_ = true;
    return !has_ended_;
  }
  /// Sends a signal as soon as `condition` holds. \returns the wait status.
  int signal_when(const std::function<bool()>& condition, int signal) {
    while (!condition() && is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_TRUE(is_running()) << "the program ended before the signal";
    ::kill(process_, signal);
    return wait();
  }
  int wait() {
    if (!has_ended_) ::waitpid(process_, &status_, 0);
    has_ended_ = true;
    return status_;
  }

 private:
  pid_t process_ = 0;
  int status_ = 0;
  bool has_ended_ = false;
};

bool has_restart_file(const fs::path& output) {
  std::error_code error;
  for (fs::recursive_directory_iterator it(output / ".lefort/scratch", error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error))
    if (it->path().filename().string().ends_with("steps.restart") &&
        !it->path().filename().string().starts_with('.'))
      return true;
  return false;
}

/// Unfinished folders and scratch files.
std::vector<std::string> leftovers_in(const fs::path& output) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(output)) {
    const std::string name = entry.path().lexically_relative(output).generic_string();
    if (name.find(".partial-") != std::string::npos ||
        name.find(".lefort/scratch/") != std::string::npos)
      names.push_back(name);
  }
  return names;
}

TEST(RunCommand, PredictsEachCaseWithEachSetAndSummarizesThem) {
  const fs::path& output = finished();
  const json group = test::read_result(output / "group.json", "group");
  EXPECT_EQ(group["participants"], 2);
  EXPECT_EQ(group["evaluations_predicted"], 4);
  EXPECT_EQ(group["sets"][0]["set"], "default");
  EXPECT_EQ(group["sets"][1]["overrides"]["tissue"]["material"]["poisson"], 0.47);
  EXPECT_EQ(group["sets"][0]["compared"], 2);
  EXPECT_FALSE(group["sets"][0]["regions"].empty());
  EXPECT_TRUE(group["evaluations"][0]["difference_to_first_set"].is_null());
  EXPECT_GT(group["evaluations"][1]["difference_to_first_set"]["max_mm"], 0.01);
  for (const char* set : {"set-default", "set-stiff"}) {
    const fs::path folder = output / "sub-case01" / set;
    const json one = test::read_result(folder / "evaluation.json", "evaluation");
    EXPECT_EQ(one["outcome"], "predicted");
    EXPECT_EQ(one["comparison"]["regions_from"], "landmarks");
    const json prediction = test::read_result(folder / "prediction.json", "prediction");
    EXPECT_FALSE(prediction.contains("timing"));
    test::read_result(folder / "timing.json", "timing");
  }
  const auto poisson = [&](const char* set) {
    const fs::path file = output / "sub-case02" / set / "prediction.json";
    return json::parse(text_of(file))["parameters"]["poisson"].get<double>();
  };
  EXPECT_EQ(poisson("set-stiff"), 0.47);
  EXPECT_NE(poisson("set-default"), 0.47);
  const json dataset = json::parse(text_of(output / "dataset_description.json"));
  EXPECT_EQ(dataset["DatasetType"], "derivative");
  EXPECT_EQ(dataset["GeneratedBy"][0]["Name"], "lefort");
  EXPECT_NE(text_of(output / "group.csv").find("case02,stiff,predicted"), std::string::npos);
  EXPECT_TRUE(leftovers_in(output).empty()) << leftovers_in(output).front();
}

TEST(RunCommand, ResultsNameNoFoldersAndDoNotDependOnThePlaceOfTheOutput) {
  const test::TemporaryFolder folder;
  const fs::path output = folder / "a/much/deeper/place";
  const auto run = test::run_lefort(run_all(output) + " --participant-label case01 --threads 1");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  for (const auto& [name, bytes] : results_of(output)) {
    EXPECT_EQ(bytes == text_of(finished() / name), true) << name << " differs";
    EXPECT_EQ(bytes.find(folder.path().string()), std::string::npos) << name;
    EXPECT_EQ(bytes.find(cohort().path.string()), std::string::npos) << name;
  }
  const std::string log = text_of(output / "logs/sub-case01_set-stiff.log");
  EXPECT_EQ(log.find(cohort().path.string()), std::string::npos) << log;
}

TEST(RunCommand, FinishedEvaluationsAreNotComputedAgain) {
  const fs::path log = finished() / "logs/sub-case01_set-stiff.log";
  const std::string before = text_of(log);
  const auto again = test::run_lefort(run_all(finished()) + " --json");
  ASSERT_EQ(again.exit_code, 0) << again.error;
  for (const json& one : json::parse(again.out)["evaluations"]) EXPECT_EQ(one["reused"], true);
  EXPECT_EQ(text_of(log), before);
  const auto listed = test::run_lefort(run_all(finished()) + " --dry-run --json");
  ASSERT_EQ(listed.exit_code, 0) << listed.error;
  const json list = json::parse(listed.out)["evaluations"];
  ASSERT_EQ(list.size(), 4U);
  EXPECT_EQ(list[3]["state"], "predicted");
  EXPECT_EQ(list[3]["files"][0], "case_02/before.nrrd");
}

TEST(RunCommand, AKilledRunResumesAndGivesTheSameBytes) {
  const test::TemporaryFolder folder;
  const fs::path output = folder / "out";
  {
    Background first(run_all(output));
    const int status = first.signal_when([&] { return has_restart_file(output); }, SIGKILL);
    EXPECT_TRUE(WIFSIGNALED(status));
  }
  EXPECT_FALSE(leftovers_in(output).empty());
  for (const char* level : {"participant", "group"}) {
    const auto rest = test::run_lefort(run_all(output, level));
    ASSERT_EQ(rest.exit_code, 0) << rest.error;
    if (level == std::string("participant")) {
      EXPECT_NE(rest.error.find("computed by an earlier run"), std::string::npos) << rest.error;
    }
  }
  expect_equal_results(finished(), output);
  EXPECT_TRUE(leftovers_in(output).empty()) << leftovers_in(output).front();
  const fs::path log = output / "logs/sub-case01_set-default.log";
  EXPECT_EQ(lines_with(log, "started"), 2);
  EXPECT_EQ(lines_with(log, "finished"), 1);
}

TEST(RunCommand, SigtermEndsItWithExitCode1AndWithoutTornResults) {
  const test::TemporaryFolder folder;
  const fs::path output = folder / "out";
  Background run(run_all(output));
  const int status = run.signal_when([&] { return has_restart_file(output); }, SIGTERM);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_FALSE(fs::exists(output / "sub-case01/set-default"));
  EXPECT_FALSE(fs::exists(output / "sub-case01/.partial-set-default"));
  EXPECT_EQ(lines_with(output / "logs/sub-case01_set-default.log", "stopped"), 1);
  const auto group = test::run_lefort(run_all(output, "group"));
  ASSERT_EQ(group.exit_code, 0) << group.error;
  EXPECT_NE(group.out.find("sub-case01, set default: missing: started once, not finished"),
            std::string::npos)
      << group.out;
}

TEST(RunCommand, SeveralProcessesComputeEachEvaluationOnce) {
  const test::TemporaryFolder folder;
  const fs::path output = folder / "out";
  {
    Background one(run_all(output) + " --threads 1"), two(run_all(output) + " --threads 1"),
        three(run_all(output) + " --threads 1");
    for (Background* process : {&one, &two, &three}) {
      const int status = process->wait();
      EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
  }
  for (const auto& entry : fs::directory_iterator(output / "logs")) {
    EXPECT_EQ(lines_with(entry.path(), "started"), 1) << entry.path();
    EXPECT_EQ(lines_with(entry.path(), "finished"), 1) << entry.path();
  }
  ASSERT_EQ(test::run_lefort(run_all(output, "group")).exit_code, 0);
  expect_equal_results(finished(), output);
}

TEST(RunCommand, ADamagedCacheEntryIsComputedAgain) {
  const test::TemporaryFolder folder;
  const std::string one = " --participant-label sub-case01 --parameter-set default --work-dir " +
                          quoted(folder / "work");
  ASSERT_EQ(test::run_lefort(run_all(folder / "first") + one).exit_code, 0);
  int damaged = 0;
  for (const auto& entry : fs::directory_iterator(folder / "work/cache")) {
    if (entry.path().extension() == ".sha256") continue;
    std::string bytes = text_of(entry.path());
    bytes[bytes.size() / 2] ^= 1;
    ASSERT_TRUE(io::write_text(entry.path(), bytes));
    ++damaged;
  }
  ASSERT_GT(damaged, 0);
  const auto run = test::run_lefort(run_all(folder / "second") + one);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_NE(run.error.find("is damaged and is computed again"), std::string::npos) << run.error;
  for (const auto& [name, bytes] : results_of(folder / "second"))
    EXPECT_EQ(bytes == text_of(finished() / name), true) << name << " differs";
}

/// The other cases are finished, one line says which case failed and why, and so does the group.
TEST(RunCommand, ACaseThatFailsDoesNotStopTheOthers) {
  const test::TemporaryFolder folder;
  const fs::path input = folder / "cohort", output = folder / "out";
  fs::create_directories(input);
  for (const char* name : {"case_01", "case_02"})
    fs::copy(cohort().path / name, input / name, fs::copy_options::recursive);
  json plan = json::parse(text_of(input / "case_01/plan.json"));
  plan["solver"] = {
      {"max_iterations", 1}, {"relative_tolerance", 1e-12}, {"min_increment_ratio", 1.0}};
  ASSERT_TRUE(io::write_text(input / "case_01/plan.json", plan.dump()));
  fs::create_directories(input / "empty");
  const std::string command =
      fmt::format("run {} {} {{}} --no-pictures", quoted(input), quoted(output));
  for (int attempt = 0; attempt < 2; ++attempt) {  // The failure of the first is stored.
    const auto run = test::run_lefort(fmt::format(fmt::runtime(command), "participant"));
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find("2 of 3 evaluations failed, the others are finished; sub-case01, set "
                             "default: failed:"),
              std::string::npos)
        << run.error;
  }
  EXPECT_EQ(lines_with(output / "logs/sub-case01_set-default.log", "started"), 1);
  EXPECT_FALSE(fs::exists(output / "sub-case01/set-default/predicted_skin.vtp"));
  const auto group = test::run_lefort(fmt::format(fmt::runtime(command), "group"));
  EXPECT_EQ(group.exit_code, 0) << group.error;
  const json result = test::read_result(output / "group.json", "group");
  EXPECT_EQ(result["evaluations_predicted"], 1);
  EXPECT_EQ(result["evaluations_failed"], 2);
  EXPECT_NE(result["evaluations"][2]["reason"].get<std::string>().find("no head before surgery"),
            std::string::npos);
}

/// A BIDS dataset of one case without a face after surgery.
void make_dataset(const fs::path& input) {
  const fs::path ct = input / "sub-07/ct", one = cohort().path / "case_01";
  fs::create_directories(ct);
  fs::create_directories(input / "derivatives");
  fs::copy(one / "before.nrrd", ct / "sub-07_ct.nrrd");
  fs::copy(one / "labels.seg.nrrd", ct / "labels.seg.nrrd");
  fs::copy(one / "plan.json", ct / "sub-07_plan.json");
}

TEST(RunCommand, ReadsABidsDataset) {
  const test::TemporaryFolder folder;
  make_dataset(folder / "dataset");
  const fs::path output = folder / "dataset/derivatives/lefort";
  const std::string command = fmt::format("run {} {} participant --participant_label 07",
                                          quoted(folder / "dataset"), quoted(output));
  const auto refused = test::run_lefort(command);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.error.find("has no dataset_description.json"), std::string::npos);
  EXPECT_FALSE(fs::exists(output));
  ASSERT_TRUE(io::write_text(folder / "dataset/dataset_description.json",
                             R"({"Name": "Heads", "BIDSVersion": "1.8.0"})"));
  const auto run = test::run_lefort(command + " --n_cpus 2 --mem_gb 2");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const fs::path result = output / "sub-07/set-default";
  EXPECT_EQ(test::read_result(result / "evaluation.json", "evaluation")["comparison"]["regions"],
            json::array());
  EXPECT_EQ(text_of(result / "predicted_skin.vtp") ==
                text_of(finished() / "sub-case01/set-default/predicted_skin.vtp"),
            true);
  EXPECT_FALSE(fs::exists(result / "inputs"));
  EXPECT_TRUE(fs::exists(result / "report.html"));
}

TEST(RunCommand, WrongArgumentsGetOneLine) {
  const test::TemporaryFolder folder;
  const auto refused = [&](const std::string& arguments, int exit_code, const std::string& says) {
    const auto run = test::run_lefort(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << arguments;
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(says), std::string::npos) << run.error;
  };
  const std::string run = run_all(folder / "out");
  refused(run + " --participant-label 99", 1,
          "there is no participant 99; there are case01, case02");
  refused(run + " --participant-label case01 sub-case01", 2, "occurs twice");
  refused(run + " --parameter-set soft", 1, "there is no parameter set soft");
  refused(run + " --mem-gb 90000", 1, "this machine has");
  refused(run_all(folder / "out", "cohort"), 2, "level");
  refused(run_all(cohort().path / "out"), 1, "must be other folders");
  ASSERT_TRUE(io::write_text(folder / "file", ""));
  refused(run_all(folder / "file/out"), 1, "cannot be created");
  const auto sets_refused = [&](const std::string& name, const std::string& text,
                                const std::string& says) {
    ASSERT_TRUE(io::write_text(folder / name, text));
    refused(fmt::format("run {} {} participant --parameters {}", quoted(cohort().path),
                        quoted(folder / "out"), quoted(folder / name)),
            1, says);
  };
  sets_refused("a.json", R"({"lefort_parameter_sets": 1, "sets": {"a": {"tissue": {"color": 1}}}})",
               "parameter set a: tissue: unknown key 'color'");
  sets_refused("b.csv", "set,tissue.element_size_mm\na,600\n",
               "parameter set a: tissue.element_size_mm");
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(RunCommand, MemoryAndDiskThatDoNotSufficeEndItWithOneLine) {
  const test::TemporaryFolder folder;
  const std::string one = " --participant-label case01 --parameter-set default";
  const auto small = test::run_lefort(run_all(folder / "out") + one + " --mem-gb 0.03");
  EXPECT_EQ(small.exit_code, 1);
  EXPECT_EQ(small.message_lines(), 1) << small.error;
  EXPECT_NE(small.error.find("memory"), std::string::npos) << small.error;
  EXPECT_FALSE(fs::exists(folder / "out/sub-case01/set-default"));
  // Files of at most 100 kB stand for a full disk.
  const auto full =
      test::run_lefort(run_all(folder / "full") + one, "ulimit -f 100; trap '' XFSZ;");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(full.message_lines(), 1) << full.error;
  EXPECT_FALSE(fs::exists(folder / "full/sub-case01/set-default"));
  const auto later = test::run_lefort(run_all(folder / "full") + one);
  EXPECT_EQ(later.exit_code, 0) << later.error;
  EXPECT_TRUE(leftovers_in(folder / "full").empty());
}

}  // namespace
}  // namespace lefort::app::test_run_command
