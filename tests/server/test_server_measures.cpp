/// \file
/// Teeth and measures of a case: jobs, their states, corrections, files, and input that is refused.
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/server/api/contract.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "support/call_api.h"
#include "support/result_file.h"
#include "support/toothed_head.h"

namespace lefort::server::test_server_measures {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::body_of;

/// Where an intraoral scanner may put its frame.
RigidTransform scanner_frame() {
  return geometry::rigid_motion({40.0, 10.0, -25.0}, {0.5, -0.8, 1.9}, Vec3::Zero());
}

/// A case with a scan, its labels and landmarks, and registered intraoral scans; tests change
/// copies of the folder.
class ServerMeasures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new test::TemporaryFolder();
    auto head = test::make_toothed_head(1.0);
    ASSERT_TRUE(head) << head.error().message;
    test::CaseApi api({}, made_->path() / "case");
    ASSERT_EQ(api.import_volume(head->scan.ct)["state"], "done");
    std::string labels;
    for (const anatomy::Tissue tissue : head->scan.labels.values) labels += char(tissue);
    const Response stored =
        api.call_api("PUT", "/labels/data", labels,
                     {{"if-match", "*"}, {"content-type", "application/octet-stream"}});
    ASSERT_EQ(stored.status, 204) << stored.text;
    json points = json::object();
    for (const plan::Landmark& one : head->landmarks)
      points[one.name] = {one.point_L.x(), one.point_L.y(), one.point_L.z()};
    ASSERT_EQ(api.put("/landmarks", {{"landmarks", points}}).status, 200);
    for (const auto& [name, arch] : {std::pair{"upper", &head->upper_L}, {"lower", &head->lower_L}})
      ASSERT_TRUE(io::write_surface(made_->path() / (std::string(name) + ".stl"),
                                    geometry::transformed(*arch, scanner_frame())));
  }
  static void TearDownTestSuite() { delete made_; }

  void SetUp() override {
    fs::copy(made_->path() / "case", root(), fs::copy_options::recursive);
    fs::remove(root() / "lock");
    api_ = std::make_unique<test::CaseApi>(UploadLimits{}, root());
  }

  [[nodiscard]] fs::path root() const { return folder_ / "case"; }
  test::CaseApi& api() { return *api_; }
  json stage(const std::string& name) { return api_->get("/case")["stages"][name]; }

  /// Uploads bytes as a file.
  std::string upload(const std::string& bytes, const std::string& name) {
    const std::string id = json::parse(api_->call_api("POST", "/uploads").text)["id"];
    Request file = test::api_request("PUT", "/uploads/" + id + "/files/0", bytes);
    file.query["name"] = name;
    EXPECT_EQ(api_->api.handle(file).status, 201);
    return id;
  }
  std::string upload_arch(const std::string& jaw) {
    return upload(io::read_text(made_->path() / (jaw + ".stl"), 1 << 28).value(),
                  "DOE^JOHN_" + jaw + ".stl");
  }
  void register_arches() {
    const json job = api_->run(
        {{"kind", "arches"}, {"upper", upload_arch("upper")}, {"lower", upload_arch("lower")}});
    ASSERT_EQ(job["state"], "done") << job.dump(1);
  }

  /// A job that fails with one line without paths.
  void expect_failed(const json& request, const std::string& reason) {
    const json job = api_->run(request);
    EXPECT_EQ(job["state"], "failed") << job.dump(1);
    const std::string message = job["message"];
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(message.find(folder_.path().string()), std::string::npos) << message;
    EXPECT_EQ(message.find("(--"), std::string::npos) << message;
  }
  /// The document of a stage, which matches the contract.
  json document(const std::string& path, const std::string& schema) {
    const Response reply = api_->call_api("GET", path);
    EXPECT_EQ(reply.status, 200) << path << reply.text;
    const auto valid = parse_by_contract(reply.text, schema);
    EXPECT_TRUE(valid) << valid.error().message;
    return valid ? *valid : json();
  }
  void expect_files(const std::string& stage_name, const std::set<std::string>& names) {
    std::set<std::string> found;
    const json listed = api_->get("/files");
    for (const json& file : listed["files"])
      if (file["stage"] == stage_name) found.insert(file["name"]);
    EXPECT_EQ(found, names);
    for (const std::string& name : names)
      EXPECT_EQ(api_->call_api("GET", "/files/" + name).status, 200) << name;
    EXPECT_TRUE(parse_by_contract(api_->call_api("GET", "/files").text, "FileList"));
  }
  void expect_surface(const std::string& name) {
    EXPECT_NE(api_->get("/surfaces").dump().find('"' + name + '"'), std::string::npos);
    EXPECT_EQ(body_of(api_->call_api("GET", "/surfaces/" + name)).substr(0, 7), "LFSURF1") << name;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<test::CaseApi> api_;
  static test::TemporaryFolder* made_;
};

test::TemporaryFolder* ServerMeasures::made_ = nullptr;

}  // namespace

TEST_F(ServerMeasures, TeethAreNumberedAndCorrected) {
  EXPECT_EQ(stage("teeth")["state"], "missing");
  const json job = api().run({{"kind", "teeth"}});
  ASSERT_EQ(job["state"], "done") << job.dump(1);
  const json teeth = document("/teeth", "Teeth")["teeth"];
  ASSERT_GE(teeth.size(), 10U);
  EXPECT_EQ(stage("teeth")["state"], "fresh");
  expect_files("teeth", {"teeth_numbered.seg.nrrd", "teeth.csv", "teeth.json", "teeth.mrk.json"});

  std::set<int> numbers;
  for (const json& tooth : teeth) numbers.insert(tooth["fdi"].get<int>());
  const int first = *numbers.begin(), second = *std::next(numbers.begin());
  int unused = 11;
  while (numbers.contains(unused) || unused % 10 == 9) ++unused;
  const auto put = [&](const json& corrections) {
    return api().put("/teeth/corrections",
                     {{"lefort_tooth_corrections", 1}, {"corrections", corrections}});
  };
  EXPECT_EQ(put({{{"found", first}, {"fdi", second}}}).status, 422);  // Another tooth has it.
  const json good{{{"found", first}, {"fdi", unused}}, {{"found", second}, {"fdi", 0}}};
  ASSERT_EQ(put(good).status, 200);
  EXPECT_EQ(document("/teeth/corrections", "ToothCorrections")["corrections"], good);
  EXPECT_EQ(json::parse(io::read_text(root() / "teeth_corrections.json", 1 << 20).value()),
            json({{"lefort_tooth_corrections", 1}, {"corrections", good}}));
  EXPECT_EQ(stage("teeth")["state"], "stale");
  EXPECT_EQ(stage("teeth")["why"], "numbers of teeth were corrected after this was computed");
  ASSERT_EQ(put(json::array()).status, 200);
  EXPECT_FALSE(fs::exists(root() / "teeth_corrections.json"));
  EXPECT_EQ(stage("teeth")["state"], "fresh");

  // A result with corrected numbers: the numbers that were found remain the keys.
  json corrected = json::parse(io::read_text(root() / "teeth/teeth.json", 1 << 20).value());
  corrected["teeth"][0]["fdi"] = unused;
  ASSERT_TRUE(io::write_text(root() / "teeth/teeth.json", corrected.dump()));
  ASSERT_TRUE(io::write_text(
      root() / "teeth/teeth_corrections.json",
      json{{"lefort_tooth_corrections", 1}, {"corrections", {{{"found", first}, {"fdi", unused}}}}}
          .dump()));
  const json tooth = document("/teeth", "Teeth")["teeth"][0];
  EXPECT_EQ(tooth["fdi"], unused);
  EXPECT_EQ(tooth["found"], first);
  EXPECT_EQ(put({{{"found", second}, {"fdi", first}}}).status,
            422);  // `first` is its number again.
}

TEST_F(ServerMeasures, CorrectionsAreChecked) {
  const auto refused = [&](const json& corrections, const std::string& reason) {
    const Response reply = api().put(
        "/teeth/corrections", {{"lefort_tooth_corrections", 1}, {"corrections", corrections}});
    EXPECT_EQ(reply.status, 422) << corrections;
    EXPECT_NE(reply.text.find(reason), std::string::npos) << reply.text;
    EXPECT_FALSE(fs::exists(root() / "teeth_corrections.json"));
  };
  refused({{{"found", 19}, {"fdi", 18}}}, "19 is no FDI number");
  refused({{{"found", 18}, {"fdi", 20}}}, "20 is no FDI number");
  refused({{{"found", 18}, {"fdi", 9}}}, "9 is no FDI number");
  refused({{{"found", 18}, {"fdi", 17}}, {{"found", 18}, {"fdi", 16}}}, "corrected twice");
  refused({{{"found", 18}, {"fdi", 17}}, {{"found", 16}, {"fdi", 17}}}, "number 17");
  refused({{{"found", 18}, {"fdi", 48}}}, "in the other jaw");
  refused({{{"found", 0}, {"fdi", 17}}}, "found");
  refused({{{"found", 18}, {"fdi", 1e9}}}, "fdi");
  refused({{{"found", 18}, {"fdi", nullptr}}}, "fdi");
  // Two teeth exchange their numbers.
  EXPECT_EQ(
      api()
          .put("/teeth/corrections",
               {{"lefort_tooth_corrections", 1},
                {"corrections", {{{"found", 16}, {"fdi", 17}}, {{"found", 17}, {"fdi", 16}}}}})
          .status,
      200);
  const std::string body = R"({"lefort_tooth_corrections":1,"corrections":[]})";
  EXPECT_EQ(api().call_api("PUT", "/teeth/corrections", body).status, 428);
  EXPECT_EQ(api().call_api("PUT", "/teeth/corrections", body, {{"if-match", "\"0\""}}).status, 412);
  ASSERT_TRUE(io::write_text(root() / "teeth_corrections.json", "[[["));
  EXPECT_EQ(api().call_api("GET", "/teeth/corrections").status, 422);

  const Response far = api().put("/nerve/points", {{"points", {{"MeF-L", {0, 0, 1e7}}}}});
  EXPECT_EQ(far.status, 422);
  EXPECT_EQ(api().put("/nerve/points", {{"points", {{"../x", {0, 0, 0}}}}}).status, 422);
  EXPECT_EQ(api().put("/nerve/points", {{"points", {{"IAN-R-100", {0, 0, 0}}}}}).status, 422);
  EXPECT_EQ(api().put("/nerve/points", {{"points", json::object()}}).status, 200);
  EXPECT_FALSE(fs::exists(root() / "nerve_points.mrk.json"));
}

TEST_F(ServerMeasures, ArchesAreRegisteredBroughtToOcclusionAndHeldByASplint) {
  expect_failed({{"kind", "occlusion"}}, "register them first");
  expect_failed({{"kind", "splint"}, {"splint", "final"}}, "register them first");
  // One jaw after the other: the first scan is kept.
  ASSERT_EQ(api().run({{"kind", "arches"}, {"upper", upload_arch("upper")}})["state"], "done");
  EXPECT_FALSE(document("/arches", "Arches").contains("lower"));
  expect_failed({{"kind", "occlusion"}}, "no intraoral scan of the lower jaw");
  ASSERT_EQ(api().run({{"kind", "arches"}, {"lower", upload_arch("lower")}})["state"], "done");
  const json arches = document("/arches", "Arches");
  for (const char* jaw : {"upper", "lower"})
    EXPECT_LT(arches[jaw]["distances"]["rms_mm"].get<double>(), 0.5) << jaw;
  EXPECT_EQ(stage("arches")["state"], "fresh");
  expect_files("arches", {"arches.json", "upper.stl", "upper.tfm", "upper_crowns.vtp", "lower.stl",
                          "lower.tfm", "lower_crowns.vtp"});
  expect_surface("upper_arch");
  expect_surface("lower_arch");

  expect_failed({{"kind", "splint"}, {"splint", "final"}}, "find it first");
  const json closed = api().run({{"kind", "occlusion"}});
  ASSERT_EQ(closed["state"], "done") << closed.dump(1);
  const json occlusion = document("/occlusion", "Occlusion");
  EXPECT_NEAR(occlusion["movement"]["superior_mm"].get<double>(), test::MadeCrowns::kOpen_mm, 0.7);
  expect_files("occlusion", {"occlusion.json", "lower_in_occlusion.stl", "lower_to_occlusion.tfm",
                             "lower_contacts.vtp"});
  expect_surface("lower_in_occlusion");

  EXPECT_EQ(occlusion["source"], "maximum intercuspation");

  const json made = api().run({{"kind", "splint"},
                               {"splint", "final"},
                               {"open_mm", 2.5},
                               {"clearance_mm", 0.15},
                               {"voxel_mm", 0.5}});
  ASSERT_EQ(made["state"], "done") << made.dump(1);
  const json splint = document("/splints/final", "Splint");
  EXPECT_EQ(splint["open_mm"], 2.5);
  EXPECT_GT(splint["volume_ml"].get<double>(), 1.0);
  EXPECT_EQ(splint["upper_pose"], json({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
  EXPECT_EQ(stage("splint_final")["state"], "fresh");
  EXPECT_EQ(stage("splint_intermediate")["state"], "missing");
  expect_files("splint_final", {"splint_final.stl", "splint_final.3mf", "splint_final.json"});
  expect_surface("splint_final");
  expect_failed({{"kind", "splint"}, {"splint", "intermediate"}}, "check it first");
  EXPECT_EQ(stage("splint_intermediate")["state"], "failed");
  EXPECT_EQ(stage("splint_final")["state"], "fresh");

  // Registered again from the stored scans: the same bytes.
  const std::string before = io::read_text(root() / "arches/arches.json", 1 << 20).value();
  ASSERT_EQ(api().run({{"kind", "arches"}})["state"], "done");
  EXPECT_EQ(io::read_text(root() / "arches/arches.json", 1 << 20).value(), before);
  EXPECT_EQ(stage("splint_final")["state"], "fresh");
  std::string text;
  for (const auto& entry : fs::recursive_directory_iterator(root()))
    if (entry.is_regular_file() && entry.path().filename() != "ct.nrrd")
      text += entry.path().string() + io::read_text(entry.path(), 1 << 28).value();
  EXPECT_EQ(text.find("DOE^JOHN"), std::string::npos);
}

TEST_F(ServerMeasures, AnOcclusionIsThatOfTheScannerOrOfBiteScans) {
  register_arches();
  const json scanned = api().run({{"kind", "occlusion"}, {"source", "as_scanned"}});
  ASSERT_EQ(scanned["state"], "done") << scanned.dump(1);
  const json occlusion = document("/occlusion", "Occlusion");
  EXPECT_EQ(occlusion["source"], "as the files were scanned");
  EXPECT_TRUE(occlusion["bites"].empty());
  EXPECT_LT(std::abs(occlusion["movement"]["superior_mm"].get<double>()), 1.0);  // Not closed.
  EXPECT_EQ(stage("occlusion")["state"], "fresh");

  const auto bite = [](const std::string& first) {
    return json{{"kind", "occlusion"}, {"source", "bite"}, {"bite", first}};
  };
  expect_failed(bite("0123456789abcdef"), "bite scan: no such upload");
  expect_failed(bite(upload("no scan", "a.dcm")), "bite scan: an intraoral scan is one file");
  expect_failed(bite(upload("solid a", "DOE^JOHN.stl")), "bite scan: ");
  json second = bite(upload_arch("upper"));
  second["bite2"] = upload("solid a", "DOE^JOHN.stl");
  expect_failed(second, "second bite scan: ");
  expect_failed(bite(upload_arch("upper")), "of the bite scan lies on the arches");
  EXPECT_EQ(document("/occlusion", "Occlusion"), occlusion);  // The earlier one is kept.
}

TEST_F(ServerMeasures, AnOcclusionFollowsRequestsAndNumbersOfTeeth) {
  register_arches();
  expect_failed({{"kind", "occlusion"}, {"midline_mm", 0}}, "number the teeth first");
  ASSERT_EQ(api().run({{"kind", "teeth"}})["state"], "done");
  const json closed = api().run({{"kind", "occlusion"}});
  ASSERT_EQ(closed["state"], "done") << closed.dump(1);
  const json free = document("/occlusion", "Occlusion");
  EXPECT_TRUE(free["relations"].contains("left_molar"));
  EXPECT_TRUE(free["requests"].empty());

  const json wanted{{"overjet_mm", free["overjet_mm"].get<double>() + 0.5},
                    {"overbite_mm", free["overbite_mm"].get<double>() + 0.1}};
  json request{{"kind", "occlusion"}, {"source", "search"}};
  request.update(wanted);
  const json job = api().run(request);
  ASSERT_EQ(job["state"], "done") << job.dump(1);
  const json found = document("/occlusion", "Occlusion");
  EXPECT_EQ(found["source"], "maximum intercuspation with requests");
  ASSERT_EQ(found["requests"].size(), 2U);
  for (const auto& [name, wanted_mm] : wanted.items()) {
    const json one = found["requests"][name];
    EXPECT_EQ(one["requested"], wanted_mm) << name;
    EXPECT_EQ(one["reached"], found[name]) << name;
    const double difference_mm = found[name].get<double>() - wanted_mm.get<double>();
    EXPECT_EQ(one["is_met"], std::abs(difference_mm) <= 0.3) << name;
    EXPECT_LT(std::abs(difference_mm), 0.5) << name;
  }
  EXPECT_EQ(found["pose"].size(), 16U);

  const auto correct = [&](const json& corrections) {
    return api()
        .put("/teeth/corrections", {{"lefort_tooth_corrections", 1}, {"corrections", corrections}})
        .status;
  };
  ASSERT_EQ(correct({{{"found", 18}, {"fdi", 0}}}), 200);
  EXPECT_EQ(stage("occlusion")["why"], "the numbers of the teeth changed, or are out of date");
  expect_failed({{"kind", "occlusion"}, {"midline_mm", 0}}, "number the teeth first");
  ASSERT_EQ(correct(json::array()), 200);
  EXPECT_EQ(stage("occlusion")["state"], "fresh");

  const json splint{{"kind", "splint"}, {"splint", "final"}, {"open_mm", 2.5}, {"voxel_mm", 0.5}};
  json with_text = splint, thick = splint, blank = splint;
  thick["rim_mm"] = 3.0;
  expect_failed(thick, "the rim is 3 mm");
  blank["text"] = "  ";
  expect_failed(blank, "no visible letter");
  with_text.update({{"text", "Case 17"}, {"rim_mm", 1.7}, {"edge_mm", 0.5}});
  const json made = api().run(with_text);
  ASSERT_EQ(made["state"], "done") << made.dump(1);
  EXPECT_EQ(document("/splints/final", "Splint")["text"], "Case 17");
  EXPECT_EQ(body_of(api().call_api("GET", "/files/splint_final.3mf")).substr(0, 2), "PK");
}

TEST_F(ServerMeasures, ScansThatAreNoneAreRefusedInOneLine) {
  expect_failed({{"kind", "arches"}}, "no intraoral scan");
  expect_failed({{"kind", "arches"}, {"upper", "0123456789abcdef"}}, "upper jaw: no such upload");
  expect_failed({{"kind", "arches"}, {"lower", upload("no scan", "a.dcm")}}, "is one file .stl");
  expect_failed({{"kind", "arches"}, {"lower", upload("solid a", "a.stl")}}, "lower jaw");
  expect_failed({{"kind", "arches"}, {"lower", upload(std::string(84, '\0'), "a.stl")}},
                "lower jaw");
  EXPECT_EQ(stage("arches")["state"], "failed");
  // The files are exchanged.
  const json swapped = api().run(
      {{"kind", "arches"}, {"upper", upload_arch("lower")}, {"lower", upload_arch("upper")}});
  EXPECT_EQ(swapped["state"], "failed") << swapped.dump(1);
  EXPECT_NE(swapped["message"].get<std::string>().find("upper jaw: "), std::string::npos);
  EXPECT_EQ(swapped["message"].get<std::string>().find("uploads"), std::string::npos);
  EXPECT_FALSE(fs::exists(root() / "intraoral_scans"));
  for (const char* request : {R"({"kind":"teeth","numbers":"a.csv"})",
                              R"({"kind":"arches","upper":"../a"})",
                              R"({"kind":"splint"})",
                              R"({"kind":"splint","splint":"final","open_mm":-1})",
                              R"({"kind":"splint","splint":"final","wall_mm":1e300})",
                              R"({"kind":"splint","splint":"intermediate","segment":"../../etc"})",
                              R"({"kind":"occlusion","source":"bite"})",
                              R"({"kind":"occlusion","source":"guess"})",
                              R"({"kind":"occlusion","bite":"0123456789abcdef"})",
                              R"({"kind":"occlusion","overjet_mm":10.5})",
                              R"({"kind":"occlusion","midline_mm":null})",
                              R"({"kind":"occlusion","source":"as_scanned","overbite_mm":1})",
                              R"({"kind":"splint","splint":"final","rim_mm":0.5})",
                              R"({"kind":"splint","splint":"final","text":"seventeen letters"})",
                              R"({"kind":"guides","segment":"../../etc"})",
                              R"({"kind":"guides","from":"behind"})",
                              R"({"kind":"guides","thickness_mm":1})",
                              R"({"kind":"guides","width_mm":1e300})",
                              R"({"kind":"guides","hole_diameter_mm":0})",
                              R"({"kind":"guides","hole_distance_mm":"5"})",
                              R"({"kind":"cephalogram","norms":"child"})",
                              R"({"kind":"landmarks","find":"/etc"})",
                              R"({"kind":"nerve","landmarks":"/etc"})"}) {
    const Response reply = api().call_api("POST", "/jobs", request);
    EXPECT_EQ(reply.status, 422) << request;
    EXPECT_TRUE(parse_by_contract(reply.text, "Error"));
  }
  EXPECT_EQ(api().call_api("GET", "/splints/night").status, 404);
}

TEST_F(ServerMeasures, ResultsNeedAScan) {
  test::CaseApi none;
  for (const json& request :
       {json{{"kind", "teeth"}}, json{{"kind", "arches"}}, json{{"kind", "occlusion"}},
        json{{"kind", "splint"}, {"splint", "final"}}, json{{"kind", "nerve"}},
        json{{"kind", "guides"}}, json{{"kind", "airway"}}, json{{"kind", "cephalogram"}},
        json{{"kind", "landmarks"}}}) {
    const json job = none.run(request);
    EXPECT_EQ(job["state"], "failed");
    EXPECT_EQ(job["message"], "the case has no scan: import one first") << request;
  }
  for (const char* path : {"/teeth", "/arches", "/occlusion", "/splints/final", "/nerve", "/guides",
                           "/airway", "/cephalogram"})
    EXPECT_EQ(none.call_api("GET", path).status, 404) << path;
}

TEST_F(ServerMeasures, LandmarksAreFoundAndThoseOfTheCaseStay) {
  const std::string before = io::read_text(root() / "landmarks.mrk.json", 1 << 20).value();
  const json job = api().run({{"kind", "landmarks"}});
  ASSERT_EQ(job["state"], "done") << job.dump(1);
  EXPECT_EQ(io::read_text(root() / "landmarks.mrk.json", 1 << 20).value(), before);
  EXPECT_EQ(stage("landmarks")["state"], "fresh");
  const json& found = job["result"]["found"];
  EXPECT_GT(found.size(), 8U) << job["result"].dump(1);
  const json points = json::parse(api().call_api("GET", "/landmarks").text)["landmarks"];
  int compared = 0;
  for (const auto& [name, one] : found.items()) {
    EXPECT_GT(one["uncertainty_mm"].get<double>(), 0.0) << name;
    // Edges and cusps of this head's landmarks are those of the head without its teeth.
    if (!points.contains(name) || name.starts_with("U") || name.starts_with("L")) continue;
    ++compared;
    double squares = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      squares +=
          std::pow(one["point_mm"][axis].get<double>() - points[name][axis].get<double>(), 2);
    EXPECT_LT(std::sqrt(squares), 6.0) << name;
  }
  EXPECT_GT(compared, 3);
  for (const auto& [name, reason] : job["result"]["missing"].items())
    EXPECT_FALSE(reason.get<std::string>().empty()) << name;
}

TEST_F(ServerMeasures, ACanalPassesThroughACorrectedPoint) {
  ASSERT_EQ(api().run({{"kind", "nerve"}})["state"], "done");
  const json found = document("/nerve", "Nerve");
  EXPECT_GT(found["left"]["length_mm"].get<double>(), 30.0);
  expect_files("nerve", {"nerve.json", "nerve.mrk.json", "nerve_right.vtp", "nerve_left.vtp"});
  expect_surface("nerve_left");
  json moved = found["points"]["IAN-L-2"];
  moved[2] = moved[2].get<double>() + 2.0;
  ASSERT_EQ(api().put("/nerve/points", {{"points", {{"IAN-L-1", moved}}}}).status, 200);
  EXPECT_EQ(stage("nerve")["state"], "stale");
  EXPECT_EQ(document("/nerve/points", "NervePoints")["points"], json({{"IAN-L-1", moved}}));
  ASSERT_EQ(api().run({{"kind", "nerve"}})["state"], "done");
  EXPECT_EQ(stage("nerve")["state"], "fresh");
  double closest_mm = 100.0;
  const auto point = [](const json& p) {
    return Vec3(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
  };
  const json line = document("/nerve", "Nerve")["left"]["points"];
  for (const json& p : line) closest_mm = std::min(closest_mm, (point(p) - point(moved)).norm());
  EXPECT_LT(closest_mm, 1.5);

  // Landmarks of the case remain in use, and other points do not replace its file.
  const std::string landmarks = io::read_text(root() / "landmarks.mrk.json", 1 << 20).value();
  EXPECT_EQ(landmarks.find("IAN"), std::string::npos);
  ASSERT_EQ(api().put("/nerve/points", {{"points", {{"MeF-L", {0, 0, 400}}}}}).status, 200);
  expect_failed({{"kind", "nerve"}}, "another scan");
  EXPECT_EQ(stage("nerve")["state"], "stale");  // The earlier canals are kept.
}

TEST_F(ServerMeasures, AirwayAndCephalogramAreMeasured) {
  const json airway = api().run({{"kind", "airway"}});
  ASSERT_EQ(airway["state"], "done") << airway.dump(1);
  EXPECT_GT(document("/airway", "Airway")["volume_ml"].get<double>(), 3.0);
  expect_files("airway", {"airway.json", "airway.csv", "airway.svg", "airway.vtp"});
  expect_surface("airway");
  const json made = api().run({{"kind", "cephalogram"}, {"norms", "male"}});
  ASSERT_EQ(made["state"], "done") << made.dump(1);
  EXPECT_GT(document("/cephalogram", "Cephalogram")["measurements"].size(), 10U);
  expect_files("cephalogram", {"cephalogram.json", "cephalometry.pdf", "lateral.png", "frontal.png",
                               "tracing.png", "measurements.csv", "norms.csv"});
  EXPECT_EQ(stage("airway")["state"], "fresh");
  json measured = json::parse(io::read_text(root() / "airway/airway.json", 1 << 20).value());
  EXPECT_FALSE(measured.contains("after"));  // There is no prediction.
  const std::string before = measured.dump();
  measured["after"] = measured;
  measured["after"]["wall_in_tissue_mesh"] = 0.4;
  ASSERT_TRUE(io::write_text(root() / "airway/airway.json", measured.dump()));
  const json after = document("/airway", "Airway")["after"];
  EXPECT_EQ(after["wall_in_tissue_mesh"], 0.4);
  EXPECT_EQ(after["min_section"]["area_mm2"], measured["min_section"]["area_mm2"]);
  ASSERT_TRUE(io::write_text(root() / "airway/airway.json", before));
  json landmarks = api().get("/landmarks");
  landmarks["landmarks"]["PNS"][2] = landmarks["landmarks"]["PNS"][2].get<double>() - 1.0;
  ASSERT_EQ(api().put("/landmarks", landmarks).status, 200);
  for (const char* name : {"airway", "cephalogram"}) {
    EXPECT_EQ(stage(name)["state"], "stale") << name;
    EXPECT_EQ(stage(name)["why"], "the landmarks changed after this was computed") << name;
  }
}

TEST_F(ServerMeasures, DamagedResultsAreRefusedInOneLine) {
  for (const auto& [folder, file, path] : {std::tuple{"teeth", "teeth.json", "/teeth"},
                                           {"arches", "arches.json", "/arches"},
                                           {"occlusion", "occlusion.json", "/occlusion"},
                                           {"splint_final", "splint.json", "/splints/final"},
                                           {"nerve", "nerve.json", "/nerve"},
                                           {"guides", "guides.json", "/guides"},
                                           {"airway", "airway.json", "/airway"},
                                           {"cephalogram", "cephalogram.json", "/cephalogram"}}) {
    fs::create_directories(root() / folder);
    for (const std::string& text :
         {std::string("{"), std::string("[]"), std::string("{}"),
          std::string(
              R"({"notice":"","teeth":[1],"upper":1,"lower":[2],"right":3,"points":4,)"
              R"("min_section":5,"measurements":6,"guides":[7,{"fit":8,"holes":[9]}],"after":1})"),
          std::string(100'000, '[')}) {
      ASSERT_TRUE(io::write_text(root() / folder / file, text));
      const Response reply = api().call_api("GET", path);
      EXPECT_EQ(reply.status, 422) << path << text.substr(0, 80) << reply.text.substr(0, 200);
      EXPECT_TRUE(parse_by_contract(reply.text, "Error"));
      EXPECT_EQ(stage(folder)["state"], "stale") << folder;
    }
  }
}

/// The Le Fort I of the head: its check names the canals, its movement the intermediate splint.
TEST_F(ServerMeasures, TheCheckUsesTheCanalsAndTheSplintTheCheckedMovement) {
  register_arches();
  const json plan{
      {"lefort_plan", 1},
      {"ct", "ct.nrrd"},
      {"landmarks", "landmarks.mrk.json"},
      {"segmentation", {{"labels", "anatomy/labels.seg.nrrd"}}},
      {"segments",
       {{{"name", "maxilla"},
         {"osteotomy", {{"template", "le-fort-1"}}},
         {"path",
          {{"steps", 2},
           {"keyframes", {{{"path_fraction", 1.0}, {"translation_mm", {0, -3, 0}}}}}}}}}}};
  const Response stored = api().put("/plan", plan);
  ASSERT_EQ(stored.status, 200) << stored.text;
  const json first = api().run({{"kind", "check"}});
  ASSERT_EQ(first["state"], "done") << first.dump(1);
  EXPECT_FALSE(first["result"].contains("nerve"));
  ASSERT_EQ(api().run({{"kind", "nerve"}})["state"], "done");
  EXPECT_EQ(stage("check")["state"], "stale");
  expect_failed({{"kind", "splint"}, {"splint", "intermediate"}}, "check it first");
  const json second = api().run({{"kind", "check"}});
  ASSERT_EQ(second["state"], "done") << second.dump(1);
  EXPECT_TRUE(second["result"].contains("nerve"));
  EXPECT_EQ(stage("check")["state"], "fresh");

  expect_failed({{"kind", "splint"}, {"splint", "intermediate"}, {"segment", "chin"}},
                "no segment chin");
  const json made = api().run(
      {{"kind", "splint"}, {"splint", "intermediate"}, {"open_mm", 1}, {"voxel_mm", 0.5}});
  ASSERT_EQ(made["state"], "done") << made.dump(1);
  const json splint = document("/splints/intermediate", "Splint");
  EXPECT_NEAR(splint["upper_pose"][7].get<double>(), -3.0, 1e-6);
  ASSERT_EQ(api().run({{"kind", "cephalogram"}})["state"], "done");
  EXPECT_EQ(stage("cephalogram")["state"], "fresh");
  bool has_after = false;
  const json cephalogram = document("/cephalogram", "Cephalogram");
  for (const json& one : cephalogram["measurements"])
    has_after = has_after || one.contains("after");
  EXPECT_TRUE(has_after);
  json other = plan;
  other["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, -2, 0};
  ASSERT_EQ(api().put("/plan", other).status, 200);
  EXPECT_EQ(stage("splint_intermediate")["state"], "stale");
  EXPECT_EQ(stage("cephalogram")["state"], "stale");
}

TEST_F(ServerMeasures, ASagittalSplitKeepsTheCanals) {
  const json landmarks = api().get("/landmarks")["landmarks"];
  const auto place = [&](const json& more) {
    json request{{"template", {{"kind", "sagittal-split"}}}, {"landmarks", landmarks}};
    request.update(more);
    return api().call_api("POST", "/osteotomies", request.dump());
  };
  const auto expect_refused = [&](const Response& reply, const std::string& reason) {
    EXPECT_EQ(reply.status, 422);
    EXPECT_TRUE(parse_by_contract(reply.text, "Error"));
    EXPECT_NE(reply.text.find(reason), std::string::npos) << reply.text;
    EXPECT_EQ(reply.text.find(folder_.path().string()), std::string::npos) << reply.text;
  };
  const auto plan_with = [&](const json& cut) {
    return json{{"lefort_plan", 1},
                {"ct", "ct.nrrd"},
                {"landmarks", "landmarks.mrk.json"},
                {"segmentation", {{"labels", "anatomy/labels.seg.nrrd"}}},
                {"segments",
                 {{{"name", "distal"},
                   {"osteotomy", {{"template", cut}}},
                   {"path", {{"keyframes", {{{"translation_mm", {0, -4, 0}}}}}}}}}}};
  };
  const json kept = plan_with({{"kind", "sagittal-split"}, {"nerve", "nerve/nerve.json"}});
  constexpr const char* kTrace = "trace the canals of the nerves first, in step 9";
  expect_refused(place({{"keep_canals", true}}), kTrace);
  expect_refused(api().put("/plan", kept), kTrace);

  ASSERT_EQ(api().run({{"kind", "nerve"}})["state"], "done");
  expect_refused(place({{"keep_canals", true}}), "canal lies too lateral");
  // The canals of this head, moved to where a split can keep them.
  json nerves = json::parse(io::read_text(root() / "nerve/nerve.json", 1 << 24).value());
  for (const auto& [side, medial_mm] : {std::pair{"right", 11.0}, {"left", -11.0}})
    for (json& p : nerves[side]["points"]) p[0] = p[0].get<double>() + medial_mm;
  ASSERT_TRUE(io::write_text(root() / "nerve/nerve.json", nerves.dump()));
  const Response plain = place(json::object()), free = place({{"keep_canals", true}});
  ASSERT_EQ(plain.status, 200) << plain.text;
  ASSERT_EQ(free.status, 200) << free.text;
  const auto placed = parse_by_contract(free.text, "Osteotomy");
  ASSERT_TRUE(placed);
  EXPECT_NE(free.text, plain.text);
  EXPECT_EQ(place({{"keep_canals", false}}).text, plain.text);
  EXPECT_NE(place({{"keep_canals", true}, {"kerf_mm", 1.0}}).text, free.text);
  expect_refused(place({{"keep_canals", true}, {"template", "genioplasty"}}), "sagittal-split");
  expect_refused(
      api().put("/plan", plan_with({{"kind", "sagittal-split"}, {"nerve", "other/nerve.json"}})),
      "names the file other/nerve.json");

  // The cut of a plan is out of date with the canals, and a job says so.
  ASSERT_EQ(api().put("/plan", kept).status, 200);
  const json cut = api().run({{"kind", "cut"}});
  ASSERT_EQ(cut["state"], "done") << cut.dump(1);
  EXPECT_EQ(cut["lines"].dump().find("trace them again"), std::string::npos);
  json point = document("/nerve", "Nerve")["points"]["IAN-L-2"];
  point[2] = point[2].get<double>() + 2.0;
  ASSERT_EQ(api().put("/nerve/points", {{"points", {{"IAN-L-1", point}}}}).status, 200);
  expect_refused(place({{"keep_canals", true}}), kTrace);
  EXPECT_NE(api().run({{"kind", "cut"}})["lines"].dump().find("trace them again"),
            std::string::npos);
  EXPECT_EQ(stage("cut")["state"], "fresh");
  ASSERT_TRUE(io::write_text(root() / "nerve/nerve.json", "{}"));
  EXPECT_EQ(stage("cut")["state"], "stale");
  expect_refused(api().put("/plan", kept), "nerve/nerve.json: not a nerve.json");
}

TEST_F(ServerMeasures, GuidesFollowTheCutsOfThePlan) {
  expect_failed({{"kind", "guides"}}, "the case has no plan");
  const json plan{{"lefort_plan", 1},
                  {"ct", "ct.nrrd"},
                  {"landmarks", "landmarks.mrk.json"},
                  {"segmentation", {{"labels", "anatomy/labels.seg.nrrd"}}},
                  {"segments",
                   {{{"name", "chin"},
                     {"osteotomy", {{"template", "genioplasty"}, {"kerf_mm", 0.8}}},
                     {"path", {{"keyframes", {{{"translation_mm", {0, -6, 2}}}}}}}}}}};
  const Response stored = api().put("/plan", plan);
  ASSERT_EQ(stored.status, 200) << stored.text;
  expect_failed({{"kind", "guides"}, {"segment", "maxilla"}}, "no segment 'maxilla'");
  expect_failed({{"kind", "guides"}, {"width_mm", 5}, {"hole_distance_mm", 15}}, "mm or more");
  EXPECT_EQ(stage("guides")["state"], "failed");
  const json checked = api().run({{"kind", "check"}});
  ASSERT_EQ(checked["state"], "done") << checked.dump(1);
  EXPECT_NE(checked["lines"].dump().find("no canals of the nerves are known"), std::string::npos);
  const auto file_of_check = [&](const char* name) {
    return io::read_text(root() / "check" / name, 1 << 24).value();
  };
  const std::string check = file_of_check("check.json"), sheet = file_of_check("worksheet.pdf");
  const json job = api().run({{"kind", "guides"}, {"segment", "chin"}, {"thickness_mm", 2.5}});
  ASSERT_EQ(job["state"], "done") << job.dump(1);
  EXPECT_EQ(job["message"].get<std::string>().find("--"), std::string::npos) << job["message"];
  EXPECT_EQ(stage("guides")["state"], "fresh");
  const json found = document("/guides", "Guides");
  EXPECT_FALSE(found["are_nerves_considered"]);
  ASSERT_EQ(found["guides"].size(), 1U);
  const json guide = found["guides"][0];
  EXPECT_EQ(guide["name"], "chin_middle");
  EXPECT_EQ(guide["put_on_from"], "anterior");
  EXPECT_NEAR(guide["slot_width_mm"].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(guide["fit"]["clearance_mm"]["median"].get<double>(), 0.1, 0.05);
  EXPECT_FALSE(guide["holes"].empty());
  expect_files("guides", {"guides.json", "holes_before.mrk.json", "holes_after.mrk.json",
                          "guide_chin_middle.stl"});
  expect_surface("guides/chin_middle");
  // The worksheet lists the guide; nothing becomes out of date by it.
  ASSERT_EQ(api().run({{"kind", "check"}})["state"], "done");
  EXPECT_NE(file_of_check("worksheet.pdf"), sheet);
  EXPECT_EQ(file_of_check("check.json"), check);
  EXPECT_EQ(stage("guides")["state"], "fresh");
  EXPECT_FALSE(fs::exists(root() / "guides/cache"));
  for (const char* name : {"chin_left", "chin_middle_0", "chin_middle_1234", "chin", "_left",
                           "chin_middlex", "..%2Fchin_middle"}) {
    EXPECT_EQ(api().call_api("GET", std::string("/surfaces/guides/") + name).status, 404) << name;
    EXPECT_EQ(api().call_api("GET", std::string("/files/guide_") + name + ".stl").status, 404);
  }

  // Out of date with the plan, the canals and the numbers of teeth.
  ASSERT_EQ(api().put("/nerve/points", {{"points", json::object()}}).status, 200);
  EXPECT_EQ(stage("guides")["state"], "fresh");
  const json corrections{{{"found", 46}, {"fdi", 47}}};
  ASSERT_EQ(api()
                .put("/teeth/corrections",
                     {{"lefort_tooth_corrections", 1}, {"corrections", corrections}})
                .status,
            200);
  EXPECT_EQ(stage("guides")["why"], "numbers of teeth were corrected after this was computed");
  ASSERT_EQ(api()
                .put("/teeth/corrections",
                     {{"lefort_tooth_corrections", 1}, {"corrections", json::array()}})
                .status,
            200);
  EXPECT_EQ(stage("guides")["state"], "fresh");
  ASSERT_EQ(api().run({{"kind", "nerve"}})["state"], "done");
  EXPECT_EQ(stage("guides")["why"], "the canals of the nerves changed after this was computed");
  const json with_canals = api().run({{"kind", "check"}});
  EXPECT_EQ(with_canals["lines"].dump().find("no canals"), std::string::npos) << with_canals;
  json other = plan;
  other["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, -5, 2};
  ASSERT_EQ(api().put("/plan", other).status, 200);
  EXPECT_EQ(stage("guides")["state"], "stale");
}

TEST_F(ServerMeasures, CorrectionsOfAnotherScanAreNotUsed) {
  ASSERT_EQ(api()
                .put("/teeth/corrections", {{"lefort_tooth_corrections", 1},
                                            {"corrections", {{{"found", 16}, {"fdi", 17}}}}})
                .status,
            200);
  ASSERT_EQ(api().put("/nerve/points", {{"points", {{"MeF-L", {20, -60, -70}}}}}).status, 200);
  auto other = test::make_toothed_head(3.0);
  ASSERT_TRUE(other);
  ASSERT_EQ(api().import_volume(other->scan.ct)["state"], "done");
  EXPECT_TRUE(document("/teeth/corrections", "ToothCorrections")["corrections"].empty());
  EXPECT_TRUE(document("/nerve/points", "NervePoints")["points"].empty());
}

}  // namespace lefort::server::test_server_measures
