/// \file
/// Conformance of the server to contract/openapi.json: routes, fixtures, and responses.
#include <lefort/server/api/api.h>
#include <lefort/server/api/contract.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "support/call_api.h"
#include "support/result_file.h"
#include "support/small_head.h"

namespace lefort::server::test_server_contract {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::body_of;

std::vector<fs::path> fixtures(const char* kind) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(LEFORT_CONTRACT) / "fixtures" / kind))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string schema_of(const fs::path& fixture) {
  const std::string name = fixture.filename();
  return name.substr(0, name.find('.'));
}

std::string text_of(const fs::path& file) { return io::read_text(file, 1 << 20).value(); }

/// Validates a response against its schema in the contract.
void expect_by_contract(const std::string& method, const std::string& pattern,
                        const Response& reply) {
  SCOPED_TRACE(method + " " + pattern);
  std::string lower = method;
  std::transform(lower.begin(), lower.end(), lower.begin(), ::tolower);
  const json& responses = contract()["paths"][pattern][lower]["responses"];
  if (reply.status == 304) return;
  if (reply.status >= 400) {
    const auto error = parse_by_contract(reply.text, "Error");
    EXPECT_TRUE(error) << error.error().message << "\n" << reply.text;
    return;
  }
  const auto response = responses.find(std::to_string(reply.status));
  ASSERT_NE(response, responses.end()) << reply.status;
  if (!response->contains("content")) {
    EXPECT_TRUE(body_of(reply).empty());
    return;
  }
  ASSERT_TRUE((*response)["content"].contains(reply.type)) << reply.type;
  const json headers = response->value("headers", json::object());
  for (const auto& [name, value] : reply.headers)
    EXPECT_TRUE(headers.contains(name) || name == "ETag") << name;
  if (reply.type != "application/json") return;
  const std::string ref = (*response)["content"][reply.type]["schema"]["$ref"];
  const auto checked = parse_by_contract(reply.text, ref.substr(ref.rfind('/') + 1));
  EXPECT_TRUE(checked) << checked.error().message << "\n" << reply.text.substr(0, 2000);
}

TEST(ServerContract, EveryValidFixtureIsAcceptedAndEveryInvalidOneRejected) {
  EXPECT_GT(fixtures("valid").size(), 35U);
  EXPECT_GT(fixtures("invalid").size(), 30U);
  for (const fs::path& file : fixtures("valid")) {
    const auto accepted = parse_by_contract(text_of(file), schema_of(file));
    EXPECT_TRUE(accepted) << file << ": " << accepted.error().message;
  }
  for (const fs::path& file : fixtures("invalid"))
    EXPECT_FALSE(parse_by_contract(text_of(file), schema_of(file))) << file;
}

TEST(ServerContract, EverySchemaHasAFixture) {
  std::set<std::string> shown;
  for (const fs::path& file : fixtures("valid")) shown.insert(schema_of(file));
  // Parts of others, which their fixtures show.
  for (const char* part :
       {"Stage", "JobKind", "JobState", "JobList", "SurfaceName", "Points", "Pose", "TemplateKind",
        "PredictionStep", "FileName", "NewtonIterate", "ValuesName", "DifferenceStatistics",
        "MovementDifference", "Interval", "Distribution", "SobolIndex", "FailedSamples"})
    shown.insert(part);
  for (const auto& [name, schema] : contract()["components"]["schemas"].items())
    EXPECT_TRUE(shown.contains(name)) << name;
}

TEST(ServerContract, TheServerHasTheContractsRoutesAndNoOthers) {
  std::set<std::string> promised, served;
  for (const auto& [path, methods] : contract()["paths"].items())
    for (const auto& [method, operation] : methods.items()) {
      std::string upper = method;
      std::transform(upper.begin(), upper.end(), upper.begin(), ::toupper);
      promised.insert(upper + " " + path);
    }
  for (const Api::RouteName& route : Api::routes())
    served.insert(std::string(route.method) + " " + std::string(route.path));
  EXPECT_EQ(promised, served);
}

TEST(ServerContract, TheSchemasRejectWhatTheServerRejects) {
  test::CaseApi api;
  const std::vector<std::pair<std::string, std::pair<std::string, std::string>>> routes{
      {"JobRequest", {"POST", "/jobs"}},
      {"Landmarks", {"PUT", "/landmarks"}},
      {"MeasurementsRequest", {"POST", "/measurements"}},
      {"Plan", {"PUT", "/plan"}},
      {"Poses", {"POST", "/poses"}},
      {"PreviewRequest", {"POST", "/preview"}},
      {"PreviewFitRequest", {"POST", "/preview/fit"}},
      {"OsteotomyRequest", {"POST", "/osteotomies"}},
      {"ToothCorrections", {"PUT", "/teeth/corrections"}},
      {"NervePoints", {"PUT", "/nerve/points"}},
      {"VariantRequest", {"POST", "/variants"}}};
  int sent = 0;
  for (const fs::path& file : fixtures("invalid"))
    for (const auto& [schema, route] : routes) {
      if (schema != schema_of(file)) continue;
      const Response reply =
          api.call_api(route.first, route.second, text_of(file), {{"if-match", "*"}});
      EXPECT_EQ(reply.status, 422) << file << reply.text;
      expect_by_contract(route.first, route.second, reply);
      ++sent;
    }
  EXPECT_GT(sent, 25);
}

TEST(ServerContract, ResponsesOfAnEmptyCaseMatchTheContract) {
  test::CaseApi api;
  for (const Api::RouteName& route : Api::routes()) {
    if (route.method != "GET" || route.path == "/events") continue;
    std::string path(route.path);
    for (const auto& [parameter, value] :
         std::vector<std::pair<std::string, std::string>>{{"{job}", "1"},
                                                          {"{surface}", "skin"},
                                                          {"{segment}", "front"},
                                                          {"{guide}", "chin_left"},
                                                          {"{variant}", "one-jaw"},
                                                          {"{step}", "1"},
                                                          {"{values}", "difference"},
                                                          {"{file}", "plan.json"},
                                                          {"{splint}", "final"}})
      if (const auto at = path.find(parameter); at != std::string::npos)
        path.replace(at, parameter.size(), value);
    expect_by_contract(std::string(route.method), std::string(route.path),
                       api.call_api("GET", path));
  }
  EXPECT_EQ(api.get("/case")["stages"]["scan"]["state"], "missing");
}

/// The whole workflow of a case; each response is validated against the contract.
TEST(ServerContract, ResponsesOfAWholeCaseMatchTheContract) {
  test::CaseApi api;
  const auto call_api = [&](const std::string& method, const std::string& pattern,
                            const std::string& path, const std::string& body = "",
                            std::map<std::string, std::string> headers = {}) {
    const Response reply = api.call_api(method, path, body, std::move(headers));
    EXPECT_LT(reply.status, 400) << method << " " << path << reply.text;
    expect_by_contract(method, pattern, reply);
    return reply;
  };
  const auto run = [&](const json& request) {
    const json job = api.run(request);
    EXPECT_EQ(job["state"], "done") << job.dump(1);
    expect_by_contract("GET", "/jobs/{job}",
                       api.call_api("GET", "/jobs/" + std::to_string(job["id"].get<int>())));
    return job;
  };
  const json imported = api.import_volume(test::small_head());
  EXPECT_EQ(imported["state"], "done") << imported.dump(1);
  EXPECT_EQ(imported.dump().find("DOE"), std::string::npos);  // File names are not kept.
  call_api("GET", "/case", "/case");
  const json volume = json::parse(call_api("GET", "/volume", "/volume").text);
  EXPECT_EQ(volume["size"], json({36, 36, 36}));
  EXPECT_EQ(body_of(call_api("GET", "/volume/data", "/volume/data")).size(), 2U * 36 * 36 * 36);
  run({{"kind", "segment"}});
  EXPECT_EQ(api.get("/case")["stages"]["anatomy"]["state"], "fresh");
  const Response labels = call_api("GET", "/labels/data", "/labels/data");
  const json named = json::parse(call_api("GET", "/labels", "/labels").text);
  EXPECT_EQ(named["names"].back(), json({{"value", 7}, {"name", "muscle"}}));

  // The brush: a voxel of bone more.
  std::string brushed = body_of(labels);
  ASSERT_EQ(brushed.size(), 36U * 36 * 36);
  brushed[36 * 36 * 18 + 36 * 18 + 18] = 1;
  const auto soft = brushed.find('\2');  // And one of muscle.
  ASSERT_NE(soft, std::string::npos);
  brushed[soft] = 7;
  call_api("PUT", "/labels/data", "/labels/data", brushed,
           {{"if-match", "*"}, {"content-type", "application/octet-stream"}});
  EXPECT_EQ(api.get("/case")["stages"]["anatomy"]["state"], "stale");
  EXPECT_EQ(body_of(call_api("GET", "/labels/data", "/labels/data")), brushed);
  run({{"kind", "segment"}, {"from_labels", true}});
  EXPECT_EQ(api.get("/case")["stages"]["anatomy"]["state"], "fresh");
  EXPECT_EQ(body_of(call_api("GET", "/labels/data", "/labels/data")), brushed);
  run({{"kind", "segment"}});

  const std::string skin = body_of(call_api("GET", "/surfaces/{surface}", "/surfaces/skin"));
  EXPECT_EQ(skin.substr(0, 8), std::string("LFSURF1\0", 8));
  std::uint32_t head[3];
  std::memcpy(head, skin.data() + 8, sizeof(head));
  EXPECT_EQ(skin.size(), 20U + 12 * head[0] + 12 * head[1]);

  call_api("PUT", "/landmarks", "/landmarks", R"({"landmarks":{"N":[0,-47,20],"A":[0,-47,-10]}})",
           {{"if-match", "*"}});
  EXPECT_EQ(api.get("/landmarks")["landmarks"]["N"], json({0, -47, 20}));
  call_api("POST", "/measurements", "/measurements",
           R"({"before":{"N":[0,-47,20],"A":[0,-47,-10]}})");
  json plan = test::small_plan();
  plan["landmarks"] = "landmarks.mrk.json";
  call_api("PUT", "/plan", "/plan", plan.dump(), {{"if-match", "*"}});
  call_api("GET", "/plan/poses", "/plan/poses");
  run({{"kind", "cut"}});
  run({{"kind", "check"}});
  run({{"kind", "preview-factor"}});
  const json surfaces = json::parse(call_api("GET", "/surfaces", "/surfaces").text);
  EXPECT_NE(surfaces.dump().find("segments/front"), std::string::npos);
  call_api("GET", "/surfaces/segments/{segment}", "/surfaces/segments/front");
  const json back{{"poses", {{"front", {1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1, 0, 0, 0, 0, 1}}}}};
  const Response depths = call_api("POST", "/poses", "/poses", back.dump());
  float deepest = 0.0F;
  const std::string bytes = body_of(depths);
  for (std::size_t at = 0; at < bytes.size(); at += 4) {
    float depth = 0.0F;
    std::memcpy(&depth, bytes.data() + at, 4);
    deepest = std::max(deepest, depth);
  }
  EXPECT_GT(deepest, 1.0F);
  EXPECT_LT(deepest, 3.5F);
  const std::string preview = body_of(call_api("POST", "/preview", "/preview", back.dump()));
  EXPECT_EQ(preview.size(), 12U * head[0]);
  Request painted =
      test::api_request("PUT", "/boundary/data", std::string(64, '\1'),
                        {{"if-match", "*"}, {"content-type", "application/octet-stream"}});
  painted.query["box"] = "16,2,16,4,4,4";
  expect_by_contract("PUT", "/boundary/data", api.api.handle(painted));
  EXPECT_EQ(body_of(call_api("GET", "/boundary/data", "/boundary/data")), std::string(64, '\1'));
  call_api("PUT", "/boundary/file", "/boundary/file",
           body_of(call_api("GET", "/files/{file}", "/files/boundary.seg.nrrd")),
           {{"if-match", "*"}, {"content-type", "application/octet-stream"}});
  call_api("DELETE", "/boundary/data", "/boundary/data", "", {{"if-match", "*"}});
  const json boundary = json::parse(call_api("GET", "/boundary", "/boundary").text);
  EXPECT_EQ(boundary["map"]["stage"], "preview");
  const Response interface = call_api("GET", "/surfaces/{surface}", "/surfaces/interface");
  std::string scalars;
  for (const auto& [name, value] : interface.headers)
    if (name == "X-Lefort-Scalars") scalars = value;
  EXPECT_EQ(scalars, "condition,rule");
  plan["boundary"] = {{"interface", "bonded"}};
  call_api("PUT", "/plan", "/plan", plan.dump(), {{"if-match", "*"}});
  run({{"kind", "preview-factor"}});
  EXPECT_NE(body_of(call_api("POST", "/preview", "/preview", back.dump())), preview);
  plan.erase("boundary");
  call_api("PUT", "/plan", "/plan", plan.dump(), {{"if-match", "*"}});
  run({{"kind", "preview-factor"}});
  EXPECT_EQ(body_of(call_api("POST", "/preview", "/preview", back.dump())), preview);
  run({{"kind", "predict"}});
  const json stages = api.get("/case")["stages"];
  for (const char* stage :
       {"scan", "anatomy", "landmarks", "plan", "cut", "check", "preview", "prediction"})
    EXPECT_EQ(stages[stage]["state"], "fresh") << stage << stages[stage];
  for (const auto& [file, kind] : {std::pair{"cut/cut.json", "cut"},
                                   {"check/check.json", "plan_check"},
                                   {"preview/preview.json", "preview"},
                                   {"prediction/prediction.json", "prediction"}})
    test::read_result(api.folder / "case" / file, kind);
  const json prediction = json::parse(call_api("GET", "/prediction", "/prediction").text);
  ASSERT_EQ(prediction["steps"].size(), 2U);
  call_api("GET", "/preview/distance", "/preview/distance");
  const std::string last =
      body_of(call_api("GET", "/prediction/steps/{step}", "/prediction/steps/2"));
  const std::string before =
      body_of(call_api("GET", "/surfaces/{surface}", "/surfaces/skin_before"));
  const std::string after = body_of(call_api("GET", "/surfaces/{surface}", "/surfaces/predicted"));
  ASSERT_EQ(last.size(), 12U * head[0]);
  for (std::size_t at = 0; at < last.size(); at += 4) {  // The last step is the prediction.
    float u = 0.0F, from = 0.0F, to = 0.0F;
    std::memcpy(&u, last.data() + at, 4);
    std::memcpy(&from, before.data() + 20 + at, 4);
    std::memcpy(&to, after.data() + 20 + at, 4);
    ASSERT_NEAR(u, to - from, 2e-4F);
  }
  EXPECT_EQ(api.call_api("GET", "/prediction/steps/3").status, 404);
  const json shifts = json::parse(
      call_api("GET", "/prediction/steps/{step}/regions", "/prediction/steps/2/regions").text);
  EXPECT_EQ(shifts["regions"][0]["region"], "whole");
  EXPECT_NEAR(shifts["regions"][0]["shift"]["max_mm"].get<double>(),
              prediction["skin_max_shift_mm"].get<double>(), 1e-3);
  EXPECT_FALSE(shifts["missing"].empty());
  EXPECT_EQ(api.call_api("GET", "/prediction/steps/3/regions").status, 404);

  const std::string bone =
      body_of(call_api("GET", "/surfaces/segments/{segment}", "/surfaces/segments/front"));
  std::uint32_t bone_vertices = 0;
  std::memcpy(&bone_vertices, bone.data() + 8, sizeof(bone_vertices));
  for (const auto& [name, maximum] : std::vector<std::pair<std::string, double>>{
           {"contact-pressure", std::numeric_limits<double>::infinity()},
           {"contact-depth",
            prediction["steps"][1]["max_penetration_increase_mm"].get<double>()}}) {
    const std::string values = body_of(call_api("GET", "/values/{values}", "/values/" + name));
    ASSERT_EQ(values.size(), 4U * bone_vertices) << name;
    float largest = 0.0F, smallest = 0.0F;
    for (std::size_t at = 0; at < values.size(); at += 4) {
      float value = 0.0F;
      std::memcpy(&value, values.data() + at, 4);
      largest = std::max(largest, value);
      smallest = std::min(smallest, value);
    }
    EXPECT_GT(largest, 0.0F) << name;
    EXPECT_LE(largest, maximum + 1e-6) << name;
    EXPECT_EQ(smallest, 0.0F) << name;
  }

  // As if surgery had changed nothing: the baseline is right and the prediction off.
  EXPECT_EQ(api.call_api("GET", "/comparison").status, 404);
  const std::string upload = json::parse(api.call_api("POST", "/uploads").text)["id"];
  Request surface = test::api_request("PUT", "/uploads/" + upload + "/files/0",
                                      body_of(api.call_api("GET", "/files/skin_before.vtp")));
  surface.query["name"] = "after.vtp";
  EXPECT_EQ(api.api.handle(surface).status, 201);
  run({{"kind", "compare"}, {"upload", upload}});
  const json found = json::parse(call_api("GET", "/comparison", "/comparison").text);
  EXPECT_EQ(found["regions"][0]["baseline_no_change"]["max_mm"], 0.0);
  EXPECT_GT(found["regions"][0]["face"]["max_mm"], 0.5);
  EXPECT_TRUE(found["movements"].empty());
  EXPECT_TRUE(found["registration"].is_null());
  const std::string difference = body_of(call_api("GET", "/values/{values}", "/values/difference"));
  EXPECT_EQ(difference.size(), 4U * head[0]);
  EXPECT_EQ(api.call_api("GET", "/values/pressure").status, 404);
  EXPECT_EQ(api.get("/case")["stages"]["comparison"]["state"], "fresh");
  const json files = api.get("/files")["files"];
  for (const json& file : files)
    call_api("GET", "/files/{file}", "/files/" + file["name"].get<std::string>());
  call_api("GET", "/files", "/files");
  call_api("GET", "/jobs", "/jobs");

  // What was made of other inputs is seen to be so; what was not, is not.
  plan["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, -2, 0};
  call_api("PUT", "/plan", "/plan", plan.dump(), {{"if-match", "*"}});
  const json after_move = api.get("/case")["stages"];
  EXPECT_EQ(after_move["prediction"]["state"], "stale");
  EXPECT_EQ(after_move["check"]["state"], "stale");
  EXPECT_EQ(after_move["cut"]["state"], "fresh");
  EXPECT_EQ(after_move["preview"]["state"], "fresh");
  plan["segments"][0]["osteotomy"]["planes"][0]["point_mm"] = {0, -17, 0};
  call_api("PUT", "/plan", "/plan", plan.dump(), {{"if-match", "*"}});
  EXPECT_EQ(api.get("/case")["stages"]["cut"]["state"], "stale");
  EXPECT_EQ(api.get("/case")["stages"]["preview"]["state"], "stale");
  EXPECT_EQ(api.get("/case")["stages"]["anatomy"]["state"], "fresh");
}

TEST(ServerContract, EventsMatchTheContract) {
  test::CaseApi api;
  std::uint64_t heard = 0;
  EXPECT_EQ(api.import_volume(test::small_head())["state"], "done");
  const std::map<std::string, std::string> schemas{{"job", "JobEvent"},
                                                   {"newton", "NewtonEvent"},
                                                   {"step", "StepEvent"},
                                                   {"case", "CaseEvent"},
                                                   {"reset", "ResetEvent"}};
  std::string text = api.api.events().wait(heard, std::chrono::milliseconds(0));
  text += api.api.events().reset_event();
  std::size_t events = 0;
  for (std::size_t at = 0; at < text.size(); ++events) {
    const std::size_t end = text.find("\n\n", at);
    const std::string event = text.substr(at, end - at);
    at = end + 2;
    const std::size_t type = event.find("\nevent: ") + 8, data = event.find("\ndata: ") + 7;
    const std::string name = event.substr(type, event.find('\n', type) - type);
    ASSERT_TRUE(schemas.contains(name)) << event;
    const auto checked = parse_by_contract(event.substr(data), schemas.at(name));
    EXPECT_TRUE(checked) << checked.error().message << event;
  }
  EXPECT_GT(events, 4U);
}

TEST(ServerContract, ACaseOfTwoSegmentsIsPreviewedAndPredicted) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.run({{"kind", "segment"}})["state"], "done");
  const Response stored = api.put("/plan", test::two_piece_plan({1, -3, 0}, {-1, -2, 0}));
  EXPECT_EQ(json::parse(stored.text)["segments"].size(), 2U);
  for (const char* kind : {"cut", "preview-factor", "predict"}) {
    const json job = api.run({{"kind", kind}});
    ASSERT_EQ(job["state"], "done") << job.dump(1);
  }
  const json prediction = api.get("/prediction");
  ASSERT_TRUE(parse_by_contract(prediction.dump(), "Prediction"));
  const json& poses = prediction["steps"][1]["poses"];
  EXPECT_EQ(poses["left"][7], -3.0);
  EXPECT_EQ(poses["right"][7], -2.0);
  EXPECT_EQ(prediction["steps"][1]["pose"], poses["left"]);

  const auto preview = [&](const json& some) {
    return api.call_api("POST", "/preview", json{{"poses", some}}.dump());
  };
  const Response one = preview({{"left", poses["left"]}});
  EXPECT_EQ(one.status, 422);
  EXPECT_NE(one.text.find("left and right"), std::string::npos) << one.text;
  const Response both = preview(poses);
  EXPECT_EQ(both.status, 200) << both.text;
  // During a drag the face follows; without it the equilibrium at the same poses is found.
  json moved = poses;
  moved["left"][7] = -3.2;
  const std::string dragged =
      body_of(api.call_api("POST", "/preview", json{{"poses", moved}, {"dragging", true}}.dump()));
  EXPECT_NE(dragged, body_of(both));
  EXPECT_NE(dragged, body_of(preview(moved)));
  json swapped = poses;
  std::swap(swapped["left"], swapped["right"]);
  EXPECT_NE(body_of(preview(swapped)), body_of(both));
  // The segment follows a point of the skin that is moved by 1 mm.
  const std::string bytes = body_of(both);
  std::vector<float> skin_mm(bytes.size() / sizeof(float));
  std::memcpy(skin_mm.data(), bytes.data(), bytes.size());
  std::size_t vertex = 0;
  for (std::size_t v = 0; v < skin_mm.size() / 3; ++v)
    if (skin_mm[3 * v + 1] < skin_mm[3 * vertex + 1]) vertex = v;
  const json at{skin_mm[3 * vertex], skin_mm[3 * vertex + 1] - 1.0F, skin_mm[3 * vertex + 2]};
  const auto fit = [&](const json& number) {
    return api.call_api("POST", "/preview/fit",
                        json{{"poses", poses},
                             {"segment", "left"},
                             {"vertex", number},
                             {"displacement_mm", at},
                             {"free", {"anterior"}}}
                            .dump());
  };
  const Response fitted = fit(vertex);
  ASSERT_EQ(fitted.status, 200) << fitted.text;
  ASSERT_TRUE(parse_by_contract(fitted.text, "PreviewFit")) << fitted.text;
  const json followed = json::parse(fitted.text);
  EXPECT_LT(followed["pose"][7], -3.5);
  EXPECT_EQ(followed["pose"][3], poses["left"][3]);
  EXPECT_NEAR(followed["displacement_mm"][1], at[1], 0.3);
  json refitted = poses;
  refitted["left"] = followed["pose"];
  const std::string again = body_of(preview(refitted));
  float y_mm = 0.0F;
  std::memcpy(&y_mm, again.data() + (3 * vertex + 1) * sizeof(float), sizeof(y_mm));
  EXPECT_NEAR(y_mm, followed["displacement_mm"][1], 1e-3);
  EXPECT_EQ(fit(skin_mm.size()).status, 422);

  const json distance = api.get("/preview/distance");
  EXPECT_GT(distance["moved_vertices"], 0);
  EXPECT_LT(distance["p50_mm"], 1.0);

  const json files = api.get("/files");
  EXPECT_TRUE(parse_by_contract(files.dump(), "FileList")) << files.dump();
  for (const std::string side : {"left", "right"}) {
    const std::string name = "bone_segment_moved_" + side + ".vtp";
    EXPECT_NE(files.dump().find(name), std::string::npos) << files.dump();
    EXPECT_EQ(api.call_api("GET", "/files/" + name).status, 200);
    Request values = test::api_request("GET", "/values/contact-depth", "");
    values.query["segment"] = side;
    const std::string surface = body_of(api.call_api("GET", "/surfaces/segments/" + side));
    std::uint32_t vertices = 0;
    std::memcpy(&vertices, surface.data() + 8, sizeof(vertices));
    EXPECT_EQ(body_of(api.api.handle(values)).size(), 4U * vertices) << side;
    values.query["segment"] = "../" + side;
    EXPECT_EQ(api.api.handle(values).status, 404);
  }
  EXPECT_EQ(api.call_api("GET", "/values/contact-depth").status, 404);
  EXPECT_EQ(api.call_api("GET", "/files/bone_segment_moved_..vtp").status, 404);
}

}  // namespace
}  // namespace lefort::server::test_server_contract
