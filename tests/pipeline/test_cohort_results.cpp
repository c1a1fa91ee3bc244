/// \file
/// The files of a cohort, and its statistics.
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/validate/calibration_report.h>
#include <lefort/pipeline/validate/case_result.h>
#include <lefort/pipeline/validate/cohort_report.h>
#include <lefort/pipeline/validate/cohort_statistics.h>
#include <lefort/pipeline/validate/find_cases.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "support/temporary_folder.h"

namespace lefort::pipeline::test_cohort_results {
namespace {

namespace fs = std::filesystem;

CaseResult result_of(const std::string& name, double prediction_mm, double no_change_mm) {
  CaseResult result{.name = name, .key = "k"};
  RegionResult chin{.region = "chin", .area_mm2 = 10.0, .compared_fraction = 1.0};
  chin.methods[0].fill(prediction_mm);
  chin.methods[1].fill(no_change_mm);
  chin.methods[2].fill(NAN);
  chin.achieved_y_mm = 3.0;
  chin.predicted_y_mm = 3.0 + prediction_mm;
  result.regions = {chin};
  result.segments = {{"mandible", {1, 2, 3}, {0, 0, 0.5}, 4.0}};
  return result;
}

CaseResult failed_case(const std::string& name) {
  CaseResult result{.name = name, .key = "k"};
  result.failure = "no, \"face\"";
  return result;
}

TEST(CohortStatistics, AreMeansOverCasesAndFailuresCount) {
  const std::vector<CaseResult> cases{result_of("a", 0.5, 2.0), result_of("b", 1.5, 3.0),
                                      failed_case("c"), result_of("d", 2.5, 2.0)};
  const auto regions = cohort_statistics(cases);
  ASSERT_EQ(regions.size(), 1U);
  const CohortRegion& chin = regions[0];
  EXPECT_EQ(chin.cases, 3);
  EXPECT_DOUBLE_EQ(chin.methods[0][0].mean, 1.5);
  EXPECT_DOUBLE_EQ(chin.gain_mm[1].mean, (1.5 + 1.5 - 0.5) / 3.0);
  EXPECT_LT(chin.methods[0][0].interval.low, 1.5);
  EXPECT_GT(chin.methods[0][0].interval.high, 1.5);
  EXPECT_DOUBLE_EQ(chin.cases_within_1mm_fraction, 0.25);
  EXPECT_DOUBLE_EQ(chin.cases_within_2mm_fraction, 0.5);
  EXPECT_DOUBLE_EQ(chin.agreement_y.bias, 1.5);
  EXPECT_TRUE(std::isnan(chin.methods[2][0].mean));
}

TEST(CohortStatistics, OfACohortThatFailedAreEmpty) {
  EXPECT_TRUE(cohort_statistics(std::vector<CaseResult>{failed_case("a")}).empty());
}

TEST(CaseResult, IsReadAsItWasWritten) {
  const test::TemporaryFolder folder;
  for (const CaseResult& result : {result_of("a", 0.1, 0.2), failed_case("b")}) {
    ASSERT_TRUE(io::write_text(folder / "result.json", as_json(result).dump()));
    const auto read = read_case_result(folder / "result.json");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(as_json(*read).dump(), as_json(result).dump());
  }
  ASSERT_TRUE(io::write_text(folder / "result.json", "{\"lefort_validation_case\": 1}"));
  EXPECT_EQ(read_case_result(folder / "result.json").error().code, ErrorCode::kFileCorrupt);
}

TEST(CohortTable, QuotesTextWithCommas) {
  CohortResults results;
  results.cases = {failed_case("b")};
  EXPECT_NE(cohort_csv(results).find(",\"no, \"\"face\"\"\"\n"), std::string::npos)
      << cohort_csv(results);
}

class CohortFolder : public testing::Test {
 protected:
  void add(const std::string& name) {
    fs::create_directories((folder_ / name).parent_path());
    ASSERT_TRUE(io::write_text(folder_ / name, name));
  }
  test::TemporaryFolder folder_;
};

TEST_F(CohortFolder, ListsFoldersByName) {
  add("b/x");
  add("a/x");
  add(".hidden/x");
  add("plan.json");
  const auto cases = list_cases(folder_.path());
  ASSERT_TRUE(cases) << cases.error().message;
  ASSERT_EQ(cases->size(), 2U);
  EXPECT_EQ(cases->front().filename(), "a");
}

TEST_F(CohortFolder, FindsTheFilesOfACase) {
  add("a/before/1.dcm");
  add("a/after_skin.ply");
  add("a/before_notes.txt");
  add("a/landmarks.mrk.json");
  add("plan.json");
  const auto one = find_case(folder_ / "a");
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(one->before_scan, folder_ / "a/before");
  EXPECT_EQ(one->after.skin, folder_ / "a/after_skin.ply");
  EXPECT_EQ(one->plan, folder_ / "plan.json");
  EXPECT_EQ(one->landmarks, folder_ / "a/landmarks.mrk.json");
  EXPECT_FALSE(one->before.skin);
  add("a/plan.json");
  EXPECT_EQ(find_case(folder_ / "a")->plan, folder_ / "a/plan.json");
}

TEST_F(CohortFolder, MissingAndAmbiguousFilesAreReported) {
  const auto reason = [&] { return find_case(folder_ / "a").error().message; };
  add("a/after_skin.ply");
  EXPECT_NE(reason().find("no head before surgery"), std::string::npos) << reason();
  add("a/before_skin.stl");
  EXPECT_NE(reason().find("no head before surgery"), std::string::npos) << reason();
  add("a/before_skull.stl");
  EXPECT_TRUE(find_case(folder_ / "a"));
  add("a/before_skull.obj");
  EXPECT_NE(reason().find("has before_skull.obj and before_skull.stl"), std::string::npos)
      << reason();
  fs::remove(folder_ / "a/before_skull.obj");
  add("a/before.nii.gz");
  EXPECT_NE(reason().find("a scan and surfaces before"), std::string::npos) << reason();
}

TEST_F(CohortFolder, FindsTheFilesOfABidsDataset) {
  add("sub-01/ct/sub-01_ct.nii.gz");
  add("sub-01/ct/sub-01_ct.json");
  add("sub-01/ct/sub-01_plan.json");
  add("sub-02/ses-before/ct/sub-02_ses-before_ct.nrrd");
  add("sub-02/ses-before/ct/sub-02_ses-before_landmarks.csv");
  add("sub-02/ses-after/ct/sub-02_ses-after_skin.ply");
  add("derivatives/lefort/x");
  add("plan.json");
  const auto cases = list_cases(folder_.path());
  ASSERT_TRUE(cases) << cases.error().message;
  ASSERT_EQ(cases->size(), 2U);
  const auto one = find_case(folder_ / "sub-01", AfterSurgery::kOptional);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(one->before_scan, folder_ / "sub-01/ct/sub-01_ct.nii.gz");
  EXPECT_EQ(one->plan, folder_ / "sub-01/ct/sub-01_plan.json");
  EXPECT_FALSE(one->has_after());
  const auto required = find_case(folder_ / "sub-01");
  ASSERT_FALSE(required);
  EXPECT_NE(required.error().message.find("no face after surgery"), std::string::npos);
  const auto two = find_case(folder_ / "sub-02");
  ASSERT_TRUE(two) << two.error().message;
  const fs::path before = folder_ / "sub-02/ses-before/ct";
  EXPECT_EQ(two->before_scan, before / "sub-02_ses-before_ct.nrrd");
  EXPECT_EQ(two->landmarks, before / "sub-02_ses-before_landmarks.csv");
  EXPECT_EQ(two->after.skin, folder_ / "sub-02/ses-after/ct/sub-02_ses-after_skin.ply");
  EXPECT_EQ(two->plan, folder_ / "plan.json");
}

/// Neither the name nor the place of a case matters, only its contents.
TEST_F(CohortFolder, TheFingerprintIsOfContents) {
  for (const char* name : {"a", "b"}) {
    fs::create_directories(folder_ / name);
    ASSERT_TRUE(io::write_text(folder_ / (std::string(name) + "/before.nrrd"), "scan"));
    ASSERT_TRUE(io::write_text(folder_ / (std::string(name) + "/after_skin.ply"), "skin"));
  }
  const auto print = [&](const char* name) {
    return fingerprint_case(*find_case(folder_ / name)).value();
  };
  EXPECT_EQ(print("a"), print("b"));
  ASSERT_TRUE(io::write_text(folder_ / "b/after_skin.ply", "Skin"));
  EXPECT_NE(print("a"), print("b"));
  const std::string before = print("a");
  ASSERT_TRUE(io::write_text(folder_ / "a/plan.json", "not a plan"));
  EXPECT_NE(print("a"), before);
}

TEST_F(CohortFolder, FilesOfAPlanThatExistAreListed) {
  fs::create_directories(folder_ / "a");
  for (const char* name : {"before.nrrd", "after_skin.ply", "paint.vtu"})
    ASSERT_TRUE(io::write_text(folder_ / "a" / name, "file"));
  const auto files = [&](const std::string& plan) {
    EXPECT_TRUE(io::write_text(folder_ / "a/plan.json", plan));
    return files_of_plan(*find_case(folder_ / "a"));
  };
  EXPECT_EQ(
      files(R"({"boundary": {"labels": "paint.vtu"}, "landmarks": "none.csv", "segments": []})"),
      std::vector<fs::path>{folder_ / "a/paint.vtu"});
  EXPECT_TRUE(files("not a plan").empty());
}

TEST(WithoutPaths, RemovesTheFoldersFromAMessage) {
  EXPECT_EQ(
      without_paths("plan /data/cohort/a/plan.json and /out/cases/a/x", "/data/cohort", "/out"),
      "plan a/plan.json and cases/a/x");
  EXPECT_EQ(without_paths("cohort/a/before.nrrd is empty", "cohort/", "out"),
            "a/before.nrrd is empty");
}

TEST(CalibrationReport, ACaseThatFailsWhenHeldOutIsFittedAndListed) {
  Calibration calibration;
  calibration.parameters = {calibration_parameters().front()};
  calibration.start = {1.0};
  calibration.all = {{2.0}, {{1.0, 3.0}}, 4, true};
  calibration.failures = {{"a", "no scan"}};
  calibration.folds = {{.held_out = "b", .fitted = calibration.all, .held_out_error_mm = 0.5},
                       {.held_out = "c",
                        .fitted = calibration.all,
                        .held_out_error_mm = NAN,
                        .failure = "step 3 did not converge"}};
  const auto json = calibration_json(calibration);
  ASSERT_EQ(json["failures"].size(), 2U);
  EXPECT_EQ(json["failures"][0]["case"], "a");
  EXPECT_EQ(json["failures"][1]["case"], "c");
  EXPECT_TRUE(json["folds"][1]["held_out_error_mm"].is_null());
  const std::string text = calibration_text(calibration);
  EXPECT_TRUE(text.starts_with("2 cases fitted, 1 not fitted, 1 failed when held out")) << text;
  EXPECT_NE(text.find("c: with the parameters that were fitted without this case: step 3"),
            std::string::npos);
}

}  // namespace
}  // namespace lefort::pipeline::test_cohort_results
