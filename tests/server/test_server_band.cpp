/// \file
/// The band of a case: computed by a job or by the command line, served, and marked when it is of
/// another plan or scan.
#include <lefort/io/read_text.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/server/api/contract.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "support/call_api.h"
#include "support/result_file.h"
#include "support/run_program.h"
#include "support/small_head.h"

namespace lefort::server::test_server_band {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::body_of;

constexpr int kSamples = 40;

/// A case whose band is computed once, by the job; tests change copies of the folder.
class ServerBand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new test::TemporaryFolder();
    test::CaseApi api({}, made_->path() / "case");
    ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
    ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);
    EXPECT_EQ(api.call_api("GET", "/uncertainty").status, 404);
    EXPECT_EQ(api.get("/case")["stages"]["uncertainty"]["state"], "missing");
    job_ = api.run({{"kind", "uncertainty"}, {"samples", kSamples}});
  }
  static void TearDownTestSuite() {
    delete made_;
    made_ = nullptr;
  }
  void SetUp() override {
    ASSERT_EQ(job_["state"], "done") << job_.dump(1);
    fs::copy(made_->path() / "case", root(), fs::copy_options::recursive);
  }
  [[nodiscard]] fs::path root() const { return folder_ / "case"; }
  [[nodiscard]] fs::path document() const { return root() / "uncertainty/uncertainty.json"; }
  static json stage_of(test::CaseApi& api) { return api.get("/case")["stages"]["uncertainty"]; }
  void expect_stale(test::CaseApi& api, const std::string& why) {
    const json stage = stage_of(api);
    EXPECT_EQ(stage["state"], "stale");
    EXPECT_NE(stage["why"].get<std::string>().find(why), std::string::npos) << stage;
    EXPECT_EQ(api.call_api("GET", "/uncertainty").status, 200);  // It is shown, and marked.
  }

  test::TemporaryFolder folder_;
  static test::TemporaryFolder* made_;
  static json job_;
};

test::TemporaryFolder* ServerBand::made_ = nullptr;
json ServerBand::job_;

std::vector<float> floats_of(const std::string& bytes, std::size_t begin, std::size_t count) {
  std::vector<float> values(count);
  std::memcpy(values.data(), bytes.data() + begin, count * sizeof(float));
  return values;
}

}  // namespace

TEST_F(ServerBand, IsServedByTheContract) {
  test::CaseApi api({}, root());
  EXPECT_EQ(stage_of(api)["state"], "fresh") << stage_of(api);
  const Response reply = api.call_api("GET", "/uncertainty");
  ASSERT_EQ(reply.status, 200) << reply.text;
  const auto valid = parse_by_contract(reply.text, "Uncertainty");
  ASSERT_TRUE(valid) << valid.error().message;
  const json file = test::read_result(document(), "uncertainty");
  for (const auto& [key, value] : valid->items()) EXPECT_EQ(value, file[key]) << key;
  EXPECT_EQ((*valid)["samples"]["count"], kSamples);
  EXPECT_NE((*valid)["notice"].get<std::string>().find("not for clinical use"), std::string::npos);
  EXPECT_EQ(job_["result"]["mean_band_mm"], file["mean_band_mm"]);
  EXPECT_EQ(job_.dump().find(made_->path().string()), std::string::npos);
  const json etag = stage_of(api)["etag"];
  EXPECT_EQ(
      api.call_api("GET", "/uncertainty", "", {{"if-none-match", etag.get<std::string>()}}).status,
      304);
  for (const char* name : {"uncertainty_report.html", "uncertainty.json", "uncertainty.vtp",
                           "samples.csv", "uncertain_inputs.json"})
    EXPECT_EQ(api.call_api("GET", std::string("/files/") + name).status, 200) << name;
  EXPECT_TRUE(parse_by_contract(api.call_api("GET", "/files").text, "FileList"));
}

TEST_F(ServerBand, HasItsMapOnTheMedianFace) {
  test::CaseApi api({}, root());
  EXPECT_NE(api.get("/surfaces").dump().find("\"band\""), std::string::npos);
  const Response reply = api.call_api("GET", "/surfaces/band");
  ASSERT_EQ(reply.status, 200) << reply.text;
  const auto scalars =
      std::find_if(reply.headers.begin(), reply.headers.end(),
                   [](const auto& one) { return one.first == "X-Lefort-Scalars"; });
  ASSERT_NE(scalars, reply.headers.end());
  EXPECT_EQ(scalars->second, "band_width_mm,p5_mm,p95_mm");
  const std::string bytes = body_of(reply);
  std::uint32_t head[3];
  std::memcpy(head, bytes.data() + 8, sizeof(head));
  const std::size_t count = head[0], begin = 20 + 12 * count + 12 * std::size_t(head[1]);
  ASSERT_EQ(head[2], 3U);
  const auto width = floats_of(bytes, begin, count),
             low = floats_of(bytes, begin + 4 * count, count),
             high = floats_of(bytes, begin + 8 * count, count);
  for (std::size_t v = 0; v < count; ++v) {
    EXPECT_LE(low[v], 0.0F);
    EXPECT_GE(high[v], 0.0F);
    EXPECT_NEAR(width[v], high[v] - low[v], 1e-4F);
  }
  double largest = 0.0;
  const json regions = api.get("/uncertainty")["regions"];
  for (const json& region : regions)
    largest = std::max(largest, region["max_band_mm"].get<double>());
  EXPECT_GE(*std::max_element(width.begin(), width.end()), float(largest) - 1e-3F);
  EXPECT_GT(largest, 0.5);
}

TEST_F(ServerBand, IsThatOfTheCommandLine) {
  const std::string before = io::read_text(document(), 1 << 28).value();
  const auto run = test::run_lefort("uncertainty '" + (root() / "plan.json").string() + "' --ct '" +
                                    (root() / "ct.nrrd").string() + "' -o '" +
                                    (root() / "uncertainty").string() + "' --samples " +
                                    std::to_string(kSamples));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_NE(run.error.find("40 of 40 coarse samples were solved"), std::string::npos) << run.error;
  EXPECT_EQ(io::read_text(document(), 1 << 28).value(), before);
  test::CaseApi api({}, root());
  EXPECT_EQ(stage_of(api)["state"], "fresh");
}

TEST_F(ServerBand, OfAnotherPlanIsMarked) {
  test::CaseApi api({}, root());
  json plan = test::small_plan();
  plan["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, -2, 0};
  ASSERT_EQ(api.put("/plan", plan).status, 200);
  expect_stale(api, "the plan changed");
  ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);
  EXPECT_EQ(stage_of(api)["state"], "fresh");
}

TEST_F(ServerBand, OfAnotherScanIsMarked) {
  test::CaseApi api({}, root());
  image::CtVolume other = test::small_head();
  other.values[1000] = 17;
  ASSERT_EQ(api.import_volume(other)["state"], "done");
  expect_stale(api, "the scan was replaced");
}

TEST_F(ServerBand, WithUnknownInputsIsMarked) {
  test::CaseApi api({}, root());
  json changed = json::parse(io::read_text(document(), 1 << 28).value());
  changed["provenance"]["ct_file_sha256"] = nullptr;  // A scan that was a folder.
  ASSERT_TRUE(io::write_text(document(), changed.dump()));
  expect_stale(api, "inputs of this band are not known");
}

TEST_F(ServerBand, ThatIsDamagedIsRefusedInOneLine) {
  test::CaseApi api({}, root());
  const json good = json::parse(io::read_text(document(), 1 << 28).value());
  json lacks = good, wrong = good;
  lacks.erase("regions");
  wrong["mean_band_mm"] = "wide";
  for (const std::string& text :
       {std::string("{"), std::string("[]"), lacks.dump(), wrong.dump(),
        R"({"regions":)" + std::string(100'000, '[') + std::string(100'000, ']') + "}"}) {
    ASSERT_TRUE(io::write_text(document(), text));
    const Response reply = api.call_api("GET", "/uncertainty");
    EXPECT_EQ(reply.status, 422) << reply.text;
    EXPECT_TRUE(parse_by_contract(reply.text, "Error")) << reply.text;
    EXPECT_EQ(api.call_api("GET", "/case").status, 200);
  }
  fs::remove(root() / "uncertainty/uncertainty.vtp");
  EXPECT_EQ(api.call_api("GET", "/surfaces/band").status, 404);
}

TEST_F(ServerBand, JobThatIsCancelledKeepsItsSamples) {
  test::CaseApi api({}, root());
  fs::remove_all(root() / "uncertainty");
  const json queued =
      json::parse(api.call_api("POST", "/jobs", R"({"kind":"uncertainty","samples":2000})").text);
  const std::string path = "/jobs/" + std::to_string(queued["id"].get<int>());
  while (api.get(path)["fraction"] == 0.0 ||
         api.get(path)["stage"].get<std::string>().find("solve 2000") == std::string::npos) {
    ASSERT_EQ(api.get(path)["ended"], json()) << api.get(path);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(stage_of(api)["state"], "running");
  ASSERT_EQ(api.call_api("DELETE", path).status, 200);
  EXPECT_EQ(api.wait_for(queued["id"])["state"], "cancelled");
  EXPECT_EQ(stage_of(api)["state"], "missing");
  EXPECT_EQ(api.call_api("GET", "/uncertainty").status, 404);
  std::size_t stored = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root() / "uncertainty/samples"))
    stored += entry.is_regular_file() ? 1 : 0;
  EXPECT_GE(stored, 16U);
}

}  // namespace lefort::server::test_server_band
