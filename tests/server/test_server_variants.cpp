/// \file
/// Variants of the plan of a case: kept, listed, loaded, deleted, put side by side, and what is
/// refused.
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/server/api/contract.h>

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "support/call_api.h"
#include "support/run_program.h"
#include "support/small_head.h"

namespace lefort::server::test_server_variants {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::body_of;

json plan_of(double forward_mm) {
  json plan = test::small_plan();
  plan["landmarks"] = "landmarks.mrk.json";
  plan["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, -forward_mm, 0};
  return plan;
}

/// A case with a plan of 3 mm that is checked and predicted; tests change copies of the folder.
class ServerVariants : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new test::TemporaryFolder();
    test::CaseApi api({}, made_->path() / "case");
    ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
    ASSERT_EQ(api.call_api("PUT", "/landmarks", R"({"landmarks":{"N":[0,-47,20],"A":[0,-47,-10]}})",
                           {{"if-match", "*"}})
                  .status,
              200);
    ASSERT_EQ(api.put("/plan", plan_of(3)).status, 200);
    for (const char* kind : {"check", "predict"})
      ASSERT_EQ(api.run({{"kind", kind}})["state"], "done");
  }
  static void TearDownTestSuite() {
    delete made_;
    made_ = nullptr;
  }
  void SetUp() override {
    fs::copy(made_->path() / "case", root(), fs::copy_options::recursive);
    restart();
  }
  void restart() {
    api_.reset();
    api_ = std::make_unique<test::CaseApi>(UploadLimits{}, root());
  }

  [[nodiscard]] fs::path root() const { return folder_ / "case"; }
  test::CaseApi& api() { return *api_; }
  json stage(const std::string& name) { return api_->get("/case")["stages"][name]; }
  Response keep(const std::string& name) {
    return api_->call_api("POST", "/variants", json{{"name", name}}.dump());
  }
  Response load(const std::string& name, const std::string& etag = "*") {
    return api_->call_api("POST", "/variants/" + name + "/load", "", {{"if-match", etag}});
  }
  void plan_and_check(double forward_mm) {
    ASSERT_EQ(api_->put("/plan", plan_of(forward_mm)).status, 200);
    ASSERT_EQ(api_->run({{"kind", "check"}})["state"], "done");
  }
  /// The list, which matches the contract, by name.
  std::map<std::string, json> list() {
    const Response reply = api_->call_api("GET", "/variants");
    const auto valid = parse_by_contract(reply.text, "VariantList");
    EXPECT_TRUE(valid) << valid.error().message << reply.text;
    std::map<std::string, json> all;
    if (valid)
      for (const json& one : (*valid)["variants"]) all[one["name"]] = one;
    return all;
  }
  /// A refusal in one line without paths that gives a reason.
  void expect_refused(const Response& reply, int status, const std::string& reason) const {
    EXPECT_EQ(reply.status, status) << reply.text;
    EXPECT_TRUE(parse_by_contract(reply.text, "Error")) << reply.text;
    EXPECT_NE(reply.text.find(reason), std::string::npos) << reply.text;
    EXPECT_EQ(reply.text.find(folder_.path().string()), std::string::npos) << reply.text;
  }
  std::string text_of(const std::string& file) const {
    return io::read_text(root() / file, 1 << 28).value_or("");
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<test::CaseApi> api_;
  static test::TemporaryFolder* made_;
};

test::TemporaryFolder* ServerVariants::made_ = nullptr;

}  // namespace

TEST_F(ServerVariants, AreKeptAcrossARestartAndLoadedWithTheirResults) {
  EXPECT_TRUE(list().empty());
  const std::string face = text_of("prediction/predicted_skin.vtp");
  ASSERT_EQ(keep("three").status, 201);
  EXPECT_EQ(list()["three"]["has_prediction"], true);
  EXPECT_EQ(list()["three"]["is_current"], true);
  EXPECT_EQ(list()["three"]["segments"], json({"front"}));

  // Another plan and another landmark; its prediction is that of the first, out of date.
  ASSERT_EQ(api()
                .call_api("PUT", "/landmarks", R"({"landmarks":{"N":[0,-46,21],"A":[0,-47,-10]}})",
                          {{"if-match", "*"}})
                .status,
            200);
  plan_and_check(2);
  EXPECT_EQ(list()["three"]["is_current"], false);
  ASSERT_EQ(keep("two").status, 201);
  EXPECT_EQ(list()["two"]["has_prediction"], false);

  restart();
  EXPECT_EQ(list().size(), 2U);
  EXPECT_EQ(list()["two"]["is_current"], true);
  // Files that are written later do not change what is kept.
  ASSERT_EQ(api().run({{"kind", "predict"}})["state"], "done");
  EXPECT_NE(text_of("prediction/predicted_skin.vtp"), face);
  EXPECT_EQ(text_of("variants/three/prediction/predicted_skin.vtp"), face);

  ASSERT_EQ(load("three").status, 204);
  EXPECT_EQ(api().get("/plan"), plan_of(3));
  EXPECT_EQ(api().get("/landmarks")["landmarks"]["N"], json({0, -47, 20}));
  for (const char* name : {"plan", "landmarks", "check", "prediction"})
    EXPECT_EQ(stage(name)["state"], "fresh") << name << stage(name);
  EXPECT_EQ(text_of("prediction/predicted_skin.vtp"), face);
  EXPECT_EQ(api().get("/prediction")["converged"], true);
  EXPECT_EQ(api().call_api("GET", "/prediction/steps/2").status, 200);
  EXPECT_EQ(list()["three"]["is_current"], true);
  EXPECT_FALSE(fs::exists(root() / "variant"));

  // Without a prediction of its own, that of the case stays and is marked.
  ASSERT_EQ(load("two").status, 204);
  EXPECT_EQ(stage("check")["state"], "fresh");
  EXPECT_EQ(stage("prediction")["state"], "stale");
  EXPECT_EQ(text_of("prediction/predicted_skin.vtp"), face);
}

TEST_F(ServerVariants, ArePutSideBySide) {
  ASSERT_EQ(keep("three").status, 201);
  plan_and_check(2);
  ASSERT_EQ(keep("two").status, 201);
  EXPECT_EQ(api().call_api("GET", "/side-by-side").status, 404);
  const json names{"three", "two"};
  json job = api().run({{"kind", "variants"}, {"names", names}});
  ASSERT_EQ(job["state"], "done") << job.dump(1);
  EXPECT_NE(job["lines"].dump().find("variant two has no predicted face"), std::string::npos);
  EXPECT_EQ(job.dump().find(folder_.path().string()), std::string::npos);
  const Response reply = api().call_api("GET", "/side-by-side");
  const auto table = parse_by_contract(reply.text, "SideBySide");
  ASSERT_TRUE(table) << table.error().message << reply.text;
  EXPECT_EQ((*table)["variants"], names);
  EXPECT_NE(reply.text.find("3.0 forward"), std::string::npos) << reply.text;
  EXPECT_NE(reply.text.find("2.0 forward"), std::string::npos) << reply.text;
  for (const char* name : {"variants.html", "variants.pdf", "variants.csv", "variants.json"})
    EXPECT_EQ(api().call_api("GET", std::string("/files/") + name).status, 200) << name;
  EXPECT_TRUE(parse_by_contract(api().call_api("GET", "/files").text, "FileList"));
  EXPECT_EQ(stage("variants")["state"], "fresh");

  // The table is that of the command line.
  const auto run = test::run_lefort("plan variants '" + (root() / "variants/three").string() +
                                    "' '" + (root() / "variants/two").string() + "' -o '" +
                                    (folder_ / "out").string() + "'");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(io::read_text(folder_ / "out/variants.csv", 1 << 20).value(),
            text_of("side_by_side/variants.csv"));

  const json surfaces = api().get("/surfaces");
  EXPECT_NE(surfaces.dump().find("\"variants/three\""), std::string::npos);
  EXPECT_EQ(surfaces.dump().find("\"variants/two\""), std::string::npos);
  EXPECT_EQ(body_of(api().call_api("GET", "/surfaces/variants/three")).substr(0, 7), "LFSURF1");
  EXPECT_EQ(api().call_api("GET", "/surfaces/variants/two").status, 404);
  EXPECT_EQ(api().call_api("GET", "/surfaces/variants/..").status, 404);

  // A variant that is replaced or removed.
  EXPECT_EQ(api().call_api("DELETE", "/variants/two").status, 204);
  EXPECT_EQ(stage("variants")["state"], "stale");
  plan_and_check(1);
  ASSERT_EQ(keep("two").status, 201);
  EXPECT_EQ(stage("variants")["state"], "stale");
  EXPECT_NE(stage("variants")["why"].get<std::string>().find("replaced"), std::string::npos);
  EXPECT_EQ(api().call_api("GET", "/side-by-side").status, 200);  // It is shown, and marked.
  ASSERT_TRUE(io::write_text(root() / "side_by_side/variants.json", R"({"variants":[3]})"));
  expect_refused(api().call_api("GET", "/side-by-side"), 422, "compare them again");
}

TEST_F(ServerVariants, OfBadNamesOrChecksAreRefusedAndNothingIsLost) {
  for (const char* name : {"", "one/two", "../plan", "a b", ".", "-\n"}) {
    const Response reply = keep(name);
    EXPECT_EQ(reply.status, 422) << name;
    EXPECT_TRUE(parse_by_contract(reply.text, "Error")) << reply.text;
  }
  EXPECT_FALSE(fs::exists(root() / "variants"));
  ASSERT_EQ(keep("three").status, 201);
  const std::string kept = text_of("variants/three/variant.json");
  expect_refused(keep("three"), 422, "choose another name");
  EXPECT_EQ(text_of("variants/three/variant.json"), kept);
  ASSERT_EQ(api().put("/plan", plan_of(2)).status, 200);
  expect_refused(keep("two"), 422, "the plan changed after this was computed");
  fs::remove(root() / "check/check.json");
  expect_refused(keep("two"), 422, "check it first");
  EXPECT_EQ(list().size(), 1U);
  EXPECT_FALSE(fs::exists(root() / "variant"));

  expect_refused(load("other"), 404, "no variant of that name");
  expect_refused(load(".."), 404, "no variant of that name");
  expect_refused(load("three", "\"0\""), 412, "");
  EXPECT_EQ(api().call_api("POST", "/variants/three/load").status, 428);
  expect_refused(api().call_api("DELETE", "/variants/other"), 404, "no variant of that name");
  expect_refused(api().call_api("DELETE", "/variants/.."), 404, "no variant of that name");
  EXPECT_EQ(api().get("/plan"), plan_of(2));

  const json one = api().run({{"kind", "variants"}, {"names", {"three", "gone"}}});
  EXPECT_EQ(one["state"], "failed");
  EXPECT_EQ(one["message"], "the case has no variant gone");
  const json twice = api().run({{"kind", "variants"}, {"names", {"three", "three"}}});
  EXPECT_EQ(twice["state"], "failed");
  EXPECT_EQ(twice["message"], "the variant three is named twice: name each once");
}

TEST_F(ServerVariants, AreLimited) {
  for (int n = 0; n < 12; ++n) ASSERT_EQ(keep("v" + std::to_string(n)).status, 201);
  expect_refused(keep("v12"), 422, "at most 12 variants");
  EXPECT_EQ(api().call_api("DELETE", "/variants/v0").status, 204);
  EXPECT_EQ(keep("v12").status, 201);
}

TEST_F(ServerVariants, OfAnotherScanAreShownAndNotLoaded) {
  ASSERT_EQ(keep("three").status, 201);
  image::CtVolume other = test::small_head();
  other.values[1000] = 17;
  ASSERT_EQ(api().import_volume(other)["state"], "done");
  EXPECT_EQ(list()["three"]["why"], "it was made on another scan");
  EXPECT_EQ(list()["three"]["is_current"], false);
  const std::string plan = text_of("plan.json");
  expect_refused(load("three"), 422, "made on another scan");
  EXPECT_EQ(text_of("plan.json"), plan);
  EXPECT_TRUE(fs::exists(root() / "prediction/prediction.json"));
  // Nor compared with a plan of the present scan.
  plan_and_check(2);
  ASSERT_EQ(keep("two").status, 201);
  const json job = api().run({{"kind", "variants"}, {"names", {"three", "two"}}});
  EXPECT_EQ(job["state"], "failed");
  EXPECT_EQ(job["message"], "three and two are plans of different heads");
}

TEST_F(ServerVariants, WithAnEarlierCheckOrDamagedAreExplained) {
  ASSERT_EQ(keep("three").status, 201);
  plan_and_check(2);
  ASSERT_EQ(keep("two").status, 201);
  json check = json::parse(text_of("variants/two/check/check.json"));
  check["lefort_plan_check"] = 1;
  ASSERT_TRUE(io::write_text(root() / "variants/two/check/check.json", check.dump()));
  const json job = api().run({{"kind", "variants"}, {"names", {"three", "two"}}});
  EXPECT_EQ(job["state"], "failed");
  EXPECT_EQ(job["message"],
            "the check of two is of another version of lefort: check the plan again");
  ASSERT_EQ(load("three").status, 204);
  ASSERT_EQ(load("two").status, 204);  // Its plan; the check has to be made again.
  EXPECT_EQ(api().get("/plan"), plan_of(2));
  EXPECT_EQ(stage("check")["state"], "missing");

  for (const char* text : {"", "[[[", R"({"lefort_variant":2})", R"({"lefort_variant":1})"}) {
    ASSERT_TRUE(io::write_text(root() / "variants/three/variant.json", text));
    EXPECT_NE(list()["three"]["why"].get<std::string>().find("damaged"), std::string::npos);
    expect_refused(load("three"), 422, "the variant three is damaged");
  }
  fs::create_directory(root() / "variants" / "not a variant");
  EXPECT_EQ(list().size(), 2U);
  EXPECT_EQ(api().get("/plan"), plan_of(2));
}

}  // namespace lefort::server::test_server_variants
