/// \file
/// Jobs, events, uploads and the case folder: nothing is lost, nothing leaves the folder.
#include <lefort/io/read_text.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/sha256.h>
#include <lefort/server/api/contract.h>
#include <lefort/server/case/event_batcher.h>
#include <lefort/server/case/event_log.h>
#include <lefort/server/case/jobs.h>
#include <lefort/server/case/solve_history.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "io/sample_scan.h"
#include "support/call_api.h"
#include "support/run_program.h"
#include "support/small_head.h"

namespace lefort::server::test_server_jobs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::milliseconds;
using test::body_of;

void nothing() {}

JobRecord wait_for(const Jobs& jobs, int id) {
  while (!jobs.find(id)->is_over()) std::this_thread::sleep_for(milliseconds(5));
  return *jobs.find(id);
}

/// Runs until it is stopped.
Result<JobOutcome> run_until_stopped(const JobRecord&, Progress& progress) {
  progress.begin_stage("wait");
  while (!progress.stop_requested()) std::this_thread::sleep_for(milliseconds(2));
  return fail(ErrorCode::kCancelled, "cancelled");
}

TEST(EventLog, ReportsWhatWasMissed) {
  EventLog log("0123abcd");
  for (int k = 1; k <= 5; ++k) log.publish("job", {{"k", k}});
  auto heard = log.find("0123abcd.3");
  ASSERT_TRUE(heard);
  const std::string missed = log.wait(*heard, milliseconds(0));
  EXPECT_EQ(missed,
            "id: 0123abcd.4\nevent: job\ndata: {\"k\":4}\n\n"
            "id: 0123abcd.5\nevent: job\ndata: {\"k\":5}\n\n");
  EXPECT_EQ(log.wait(*heard, milliseconds(0)), "");
}

TEST(EventLog, RejectsIdsOfAnotherStart) {
  EventLog log("0123abcd");
  log.publish("job", {});
  for (const char* id : {"", "0123abce.1", "0123abcd", "0123abcd.", "0123abcd.2", "0123abcd.-1",
                         "0123abcd.1x", "0123abcd.99999999999999999999"})
    EXPECT_FALSE(log.find(id)) << id;
  EXPECT_TRUE(log.find("0123abcd.0"));
  EXPECT_TRUE(log.find("0123abcd.1"));
}

TEST(EventLog, RemovesTheOldestAndReportsIt) {
  EventLog log("0123abcd");
  std::uint64_t heard = 0;
  for (int k = 0; k < 5000; ++k) log.publish("job", {{"k", k}});
  EXPECT_FALSE(log.find("0123abcd.1"));
  EXPECT_EQ(log.wait(heard, milliseconds(0)), log.reset_event());
  EXPECT_EQ(heard, 5000U);
  for (int k = 0; k < 20; ++k) log.publish("job", {{"text", std::string(1 << 20, 'x')}});
  EXPECT_FALSE(log.find("0123abcd.5010"));  // Bounded in bytes, too.
}

TEST(Jobs, RunOneAfterTheOther) {
  const test::TemporaryFolder folder;
  EventLog log("0123abcd");
  std::atomic<int> running = 0, maximum = 0;
  Jobs jobs(
      folder.path(), log,
      [&](const JobRecord& job, Progress& progress) -> Result<JobOutcome> {
        maximum = std::max<int>(maximum, ++running);
        progress.note("line of " + job.kind);
        std::this_thread::sleep_for(milliseconds(10));
        --running;
        if (job.kind == "bad") return fail(ErrorCode::kPlanInvalid, "it is bad");
        return JobOutcome{"good", {{"n", 1}}};
      },
      nothing);
  ASSERT_TRUE(jobs.submit("good", json::object()));
  ASSERT_TRUE(jobs.submit("bad", json::object()));
  EXPECT_EQ(wait_for(jobs, 2).state, "failed");
  EXPECT_EQ(jobs.find(2)->message, "it is bad");
  EXPECT_EQ(jobs.find(1)->state, "done");
  EXPECT_EQ(jobs.find(1)->lines.front(), "line of good");
  EXPECT_EQ(maximum, 1);
}

TEST(Jobs, CanBeCancelledWhileWaitingAndWhileRunning) {
  const test::TemporaryFolder folder;
  EventLog log("0123abcd");
  Jobs jobs(folder.path(), log, run_until_stopped, nothing);
  ASSERT_TRUE(jobs.submit("first", json::object()));
  ASSERT_TRUE(jobs.submit("second", json::object()));
  EXPECT_EQ(jobs.cancel(2)->state, "cancelled");
  ASSERT_TRUE(jobs.cancel(1));
  while (jobs.find(1)->state == "queued") {  // It may not have begun.
  }
  EXPECT_EQ(wait_for(jobs, 1).state, "cancelled");
  EXPECT_FALSE(jobs.cancel(3));
}

TEST(Jobs, AnExceptionInAJobStopsNeitherWorkerNorServer) {
  const test::TemporaryFolder folder;
  EventLog log("0123abcd");
  Jobs jobs(
      folder.path(), log,
      [](const JobRecord& job, Progress&) -> Result<JobOutcome> {
        if (job.kind == "throws") throw std::runtime_error("oops");
        return JobOutcome{};
      },
      nothing);
  ASSERT_TRUE(jobs.submit("throws", json::object()));
  ASSERT_TRUE(jobs.submit("works", json::object()));
  EXPECT_EQ(wait_for(jobs, 2).state, "done");
  EXPECT_EQ(jobs.find(1)->state, "failed");
  EXPECT_EQ(jobs.find(1)->message, "internal error");
}

TEST(Jobs, AnExceptionInTheCallbackDoesNotStopTheWorker) {
  const test::TemporaryFolder folder;
  EventLog log("0123abcd");
  const auto here = std::this_thread::get_id();
  Jobs jobs(
      folder.path(), log,
      [](const JobRecord&, Progress&) -> Result<JobOutcome> { return JobOutcome{}; },
      [here] {
        if (std::this_thread::get_id() != here) throw std::runtime_error("oops");
      });
  ASSERT_TRUE(jobs.submit("one", json::object()));
  ASSERT_TRUE(jobs.submit("two", json::object()));
  EXPECT_EQ(wait_for(jobs, 2).state, "done");
}

TEST(Jobs, OfAnEarlierServerAreReported) {
  const test::TemporaryFolder folder;
  EventLog log("0123abcd");
  {
    Jobs jobs(folder.path(), log, run_until_stopped, nothing);
    ASSERT_TRUE(jobs.submit("running", json::object()));
    ASSERT_TRUE(jobs.submit("waiting", json::object()));
    while (jobs.find(1)->state != "running") std::this_thread::sleep_for(milliseconds(1));
  }
  std::ofstream(folder / "7.json") << "not a job";
  std::ofstream(folder / "8.json") << R"({"id": 9})";
  Jobs jobs(folder.path(), log, run_until_stopped, nothing);
  ASSERT_EQ(jobs.all().size(), 2U);
  EXPECT_EQ(jobs.find(1)->state, "interrupted");
  EXPECT_EQ(jobs.find(2)->state, "interrupted");
  EXPECT_EQ(jobs.submit("next", json::object())->id, 3);
}

TEST(Jobs, AreRejectedIfTheQueueIsFull) {
  const test::TemporaryFolder folder;
  EventLog log("0123abcd");
  Jobs jobs(folder.path(), log, run_until_stopped, nothing);
  int taken = 0;
  while (taken < 100 && jobs.submit("one more", json::object())) ++taken;
  EXPECT_GE(taken, 8);
  EXPECT_LE(taken, 9);
}

TEST(CaseFolder, IsLockedByOneServer) {
  const test::TemporaryFolder folder;
  auto first = CaseFolder::open(folder / "case");
  ASSERT_TRUE(first);
  const auto second = CaseFolder::open(folder / "case");
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("in use by another lefort serve"), std::string::npos);
}

TEST(CaseFolder, IsPrivateAndRemovesUploads) {
  const test::TemporaryFolder folder;
  const auto mode = [&](const char* name) { return fs::status(folder / name).permissions(); };
  {
    test::CaseApi api({}, folder / "case");
    EXPECT_EQ(api.call_api("POST", "/uploads").status, 201);
    EXPECT_EQ(mode("case"), fs::perms::owner_all);
    EXPECT_EQ(mode("case/uploads"), fs::perms::owner_all);
  }
  EXPECT_TRUE(fs::exists(folder / "case"));
  EXPECT_FALSE(fs::exists(folder / "case/uploads"));
}

TEST(CaseFolder, DetectsAReplacedFileOfTheSameSizeAndTime) {
  const test::TemporaryFolder folder;
  const auto opened = CaseFolder::open(folder / "case");
  ASSERT_TRUE(opened);
  const fs::path file = opened->plan(), other = folder / "case/other";
  std::ofstream(file) << "one";
  const auto first = opened->fingerprint(file);
  ASSERT_TRUE(first);
  EXPECT_EQ(opened->fingerprint(file), first);
  std::ofstream(other) << "two";
  fs::last_write_time(other, fs::last_write_time(file));
  fs::rename(other, file);
  EXPECT_NE(opened->fingerprint(file), first);
  EXPECT_FALSE(opened->fingerprint(folder.path()));
}

TEST(Uploads, ABodyThatThrowsReleasesItsReservation) {
  test::CaseApi api({.file_bytes = 1000, .all_bytes = 1000, .files = 3, .uploads = 2});
  const std::string id = json::parse(api.call_api("POST", "/uploads").text)["id"];
  Request file = test::api_request("PUT", "/uploads/" + id + "/files/0", std::string(1000, 'x'));
  file.query["name"] = "x";
  Request broken = file;
  broken.read_body = [](const BodyTaker&) -> bool { throw std::runtime_error("oops"); };
  EXPECT_THROW(static_cast<void>(api.api.handle(broken)), std::runtime_error);
  EXPECT_EQ(std::distance(fs::directory_iterator(api.folder / "case/uploads"), {}), 1);
  EXPECT_EQ(api.api.handle(file).status, 201);
  EXPECT_EQ(std::distance(fs::directory_iterator(api.folder / "case/uploads"), {}), 1);
}

TEST(Uploads, AreStoredUnderGeneratedNamesAndWithinLimits) {
  test::CaseApi api({.file_bytes = 1000, .all_bytes = 1500, .files = 3, .uploads = 2});
  const auto begin = [&] {
    return json::parse(api.call_api("POST", "/uploads").text)["id"].get<std::string>();
  };
  const auto send = [&](const std::string& id, const std::string& index, const std::string& name,
                        const std::string& bytes) {
    Request file = test::api_request("PUT", "/uploads/" + id + "/files/" + index, bytes);
    file.query["name"] = name;
    return api.api.handle(file).status;
  };
  const std::string id = begin();
  EXPECT_EQ(send(id, "0", "../../../DOE JOHN.dcm", "abc"), 201);
  EXPECT_EQ(send(id, "1", "DOE^JOHN", std::string(1000, 'x')), 201);
  EXPECT_EQ(send(id, "2", "x", std::string(600, 'x')), 413);   // All together.
  EXPECT_EQ(send(id, "2", "x", std::string(1001, 'x')), 413);  // One.
  EXPECT_EQ(send(id, "3", "x", "abc"), 422);
  EXPECT_EQ(send(id, "-1", "x", "abc"), 422);
  EXPECT_EQ(send(id, "1e0", "x", "abc"), 422);
  EXPECT_EQ(send(id, "2", "volume.nhdr", "abc"), 422);  // Names other files.
  EXPECT_EQ(send("0123456789abcdef", "0", "x", "abc"), 404);
  EXPECT_EQ(send("..", "0", "x", "abc"), 404);
  for (const auto& entry : fs::recursive_directory_iterator(api.folder.path()))
    EXPECT_EQ(entry.path().filename().string().find("DOE"), std::string::npos) << entry.path();
  // A body that ends early leaves nothing.
  Request cut = test::api_request("PUT", "/uploads/" + id + "/files/2", "abc");
  cut.query["name"] = "x";
  cut.content_length = 10;
  EXPECT_EQ(api.api.handle(cut).status, 400);
  EXPECT_EQ(std::distance(fs::directory_iterator(api.folder / "case/uploads/" / id), {}), 2);
  EXPECT_EQ(api.call_api("DELETE", "/uploads/" + id).status, 204);
  EXPECT_FALSE(fs::exists(api.folder / "case/uploads" / id));
  // A third ends the first.
  const std::string one = begin(), two = begin(), three = begin();
  EXPECT_EQ(send(one, "0", "x", "abc"), 404);
  EXPECT_EQ(send(two, "0", "x", "abc"), 201);
  EXPECT_EQ(send(three, "0", "x", "abc"), 201);
}

TEST(Uploads, AreKeptWhileAJobReadsThem) {
  const test::TemporaryFolder folder;
  Uploads uploads(folder.path(), {.uploads = 2});
  const auto begin = [&] { return json::parse(uploads.begin().text)["id"].get<std::string>(); };
  const auto send = [&](const std::string& id, int index) {
    return uploads.put(id, index, "a.dcm", test::api_request("PUT", "/", "abc")).status;
  };
  const std::string id = begin();
  EXPECT_FALSE(uploads.source(id));  // Empty.
  ASSERT_EQ(send(id, 0), 201);
  {
    const auto source = uploads.source(id);
    ASSERT_TRUE(source);
    EXPECT_EQ(send(id, 1), 422);
    begin();
    begin();  // The third ends the first, which is still read.
    EXPECT_TRUE(fs::exists(source->path() / "f00000.dcm"));
    EXPECT_EQ(send(id, 1), 404);
    EXPECT_FALSE(uploads.source(id));
    EXPECT_EQ(uploads.remove(id).status, 404);
  }
  EXPECT_FALSE(fs::exists(folder.path() / id));
  const std::string other = begin();
  ASSERT_EQ(send(other, 0), 201);
  {
    const auto first = uploads.source(other), second = uploads.source(other);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(uploads.remove(other).status, 204);
    EXPECT_TRUE(fs::exists(first->path()));
  }
  EXPECT_FALSE(fs::exists(folder.path() / other));
}

TEST(EventBatcher, ReportsAllInOrderAtMostTenTimesASecond) {
  std::vector<json> batches;
  EventBatcher iterates([&](json batch) { batches.push_back(std::move(batch)); });
  const auto start = EventBatcher::Clock::now();
  for (int k = 0; k < 1000; ++k) iterates.add(k, start + milliseconds(2 * k));  // For two seconds.
  EXPECT_EQ(batches.front(), json::array({0}));  // The first at once.
  EXPECT_LE(batches.size(), 20U);
  EXPECT_GE(batches.size(), 19U);
  iterates.flush(start + milliseconds(2000));
  iterates.flush(start + milliseconds(2001));  // Nothing is waiting.
  json all = json::array();
  for (const json& batch : batches) {
    EXPECT_FALSE(batch.empty());
    all.insert(all.end(), batch.begin(), batch.end());
  }
  ASSERT_EQ(all.size(), 1000U);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(all[std::size_t(k)], k);
  iterates.add("late", start + milliseconds(5000));
  EXPECT_EQ(batches.back(), json::array({"late"}));
}

/// Malformed scans, and headers that name files elsewhere.
TEST(Uploads, OtherThanScansGiveOneClearLine) {
  test::CaseApi api;
  std::ofstream(api.folder / "secret.raw") << std::string(8, 'S');
  const std::string nrrd =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 1 2 2\nencoding: raw\n"
      "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) "
      "(0,0,1)\nspace origin: (0,0,0)\nendian: little\n";
  const std::string outside = (api.folder / "secret.raw").string();
  const std::string mha =
      "ObjectType = Image\nNDims = 3\nDimSize = 1 2 2\nElementType = "
      "MET_SHORT\nElementSpacing = 1 1 1\nBinaryData = True\n"
      "ElementDataFile = ";
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"empty.nrrd", ""},
           {"text.nrrd", "hello"},
           {"elsewhere.nrrd", nrrd + "data file: " + outside + "\n\n"},
           {"up.nrrd", nrrd + "data file: ../../../secret.raw\n\n"},
           {"list.nrrd", nrrd + "data file: LIST\n" + outside + "\n"},
           {"elsewhere.mha", mha + outside + "\n"},
           {"up.mha", mha + "../../../secret.raw\n"},
           {"list.mha", mha + "LIST\n" + outside + "\n"},
           {"bad.nii", std::string(400, 'n')},
           {"bad.nii.gz", "\x1f\x8b" + std::string(60, 'z')},
           {"bad.inv3", std::string(1024, 'i')},
           {"bad.dcm", std::string(128, '\0') + "DICM" + std::string(100, 'd')},
           {"noname", "noname"}}) {
    const std::string id = json::parse(api.call_api("POST", "/uploads").text)["id"];
    Request file = test::api_request("PUT", "/uploads/" + id + "/files/0", bytes);
    file.query["name"] = name;
    EXPECT_EQ(api.api.handle(file).status, 201) << name;
    const json job = api.run({{"kind", "import"}, {"upload", id}});
    EXPECT_EQ(job["state"], "failed") << name;
    const std::string message = job["message"];
    EXPECT_FALSE(message.empty()) << name;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(message.find(api.folder.path().string()), std::string::npos) << message;
  }
  EXPECT_EQ(api.get("/case")["stages"]["scan"]["state"], "failed");
}

std::map<std::string, std::string> states_of(test::CaseApi& api) {
  std::map<std::string, std::string> states;
  const json stages = api.get("/case")["stages"];
  for (const auto& [name, stage] : stages.items()) states[name] = stage["state"].get<std::string>();
  return states;
}

TEST(CaseApi, LandmarksPlanAndPaintOfAnotherScanAreStale) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.put("/landmarks", {{"landmarks", {{"N", {1, 2, 3}}}}}).status, 200);
  ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);
  Request paint =
      test::api_request("PUT", "/boundary/data", "\1",
                        {{"if-match", "*"}, {"content-type", "application/octet-stream"}});
  paint.query["box"] = "3,4,5,1,1,1";
  ASSERT_LT(api.api.handle(paint).status, 300);
  const auto expect_states = [&](const std::string& state) {
    auto states = states_of(api);
    for (const char* stage : {"landmarks", "plan", "boundary"}) EXPECT_EQ(states[stage], state);
  };
  expect_states("fresh");
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");  // The same scan.
  expect_states("fresh");
  image::CtVolume other = test::small_head();
  other.values[1000] = 17;
  ASSERT_EQ(api.import_volume(other)["state"], "done");
  expect_states("stale");
  const json job = api.run({{"kind", "cut"}});
  EXPECT_NE(job.dump().find("were made on another scan"), std::string::npos) << job.dump(1);

  ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);  // Checked by the user.
  EXPECT_EQ(states_of(api)["plan"], "fresh");
  EXPECT_EQ(states_of(api)["landmarks"], "stale");
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");  // The first scan again.
  EXPECT_EQ(states_of(api)["plan"], "stale");
  EXPECT_EQ(states_of(api)["landmarks"], "fresh");
}

/// Cases of earlier versions have no record of the scan.
TEST(CaseApi, APlanWithoutARecordOfItsScanBecomesStaleWithTheNext) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_TRUE(io::write_text(api.folder / "case/plan.json", test::small_plan().dump()));
  EXPECT_EQ(states_of(api)["plan"], "fresh");
  image::CtVolume other = test::small_head();
  other.values[1000] = 17;
  ASSERT_EQ(api.import_volume(other)["state"], "done");
  EXPECT_EQ(states_of(api)["plan"], "stale");
}

TEST(CaseFolder, ScanAndDescriptionChangeTogether) {
  const test::TemporaryFolder folder;
  const fs::path root = folder / "case";
  const std::string old_scan = "the old scan", new_scan = "the new scan";
  const auto put = [&](const fs::path& at, const std::string& scan, const char* title) {
    fs::create_directories(at);
    test::write_bytes(at / "ct.nrrd", scan);
    test::write_bytes(
        at / "case.json",
        json({{"ct_sha256", io::sha256_of_file(at / "ct.nrrd").value()}, {"title", title}}).dump());
  };
  const auto title = [&] { return CaseFolder::open(root).value().describe().value("title", ""); };
  const auto scan = [&] { return io::read_text(root / "ct.nrrd", 100).value(); };
  put(root, old_scan, "old");
  put(root / "import", new_scan, "new");  // Interrupted while it was prepared.
  EXPECT_EQ(title(), "old");
  EXPECT_EQ(scan(), old_scan);
  EXPECT_FALSE(fs::exists(root / "import"));

  put(root / "imported", new_scan, "new");  // Interrupted before the first move, ...
  EXPECT_EQ(title(), "new");
  EXPECT_EQ(scan(), new_scan);
  EXPECT_FALSE(fs::exists(root / "imported"));

  put(root, old_scan, "old");
  put(root / "imported", new_scan, "new");
  fs::rename(root / "imported/ct.nrrd", root / "ct.nrrd");  // ... between the moves.
  EXPECT_EQ(title(), "new");
  EXPECT_EQ(scan(), new_scan);

  test::write_bytes(root / "ct.nrrd", "a scan that was put here by hand");
  EXPECT_EQ(title(), "");
}

TEST(CaseFolder, RemovesUnfinishedFilesOfAKilledProcess) {
  const test::TemporaryFolder folder;
  const fs::path unfinished = folder / "case/prediction/paraview/.partial-0123-step.vtu";
  fs::create_directories(unfinished.parent_path());
  test::write_bytes(unfinished, "half");
  test::write_bytes(unfinished.parent_path() / "step.vtu", "whole");
  ASSERT_TRUE(CaseFolder::open(folder / "case"));
  EXPECT_FALSE(fs::exists(unfinished));
  EXPECT_TRUE(fs::exists(unfinished.parent_path() / "step.vtu"));
}

TEST(CaseApi, DeeplyNestedDocumentsOfACaseFolderAreIgnored) {
  const test::TemporaryFolder folder;
  const std::string nested = std::string(200'000, '[') + std::string(200'000, ']');
  fs::create_directories(folder / "case/jobs");
  fs::create_directories(folder / "case/prediction");
  test::write_bytes(folder / "case/plan.json", R"({"segments":[],"x":)" + nested + "}");
  test::write_bytes(folder / "case/prediction/prediction.json", R"({"inputs":)" + nested + "}");
  test::write_bytes(folder / "case/stages.json", R"({"prediction":)" + nested + "}");
  test::write_bytes(folder / "case/case.json", R"({"scan":)" + nested + "}");
  const std::string record =
      R"("kind":"cut","parameters":{},"state":"done","stage":"","fraction":1,"lines":[],)"
      R"("message":"","created":"","ended":null,"result":)";
  test::write_bytes(folder / "case/jobs/1.json", R"({"id":1,)" + record + nested + "}");
  test::write_bytes(folder / "case/jobs/2147483647.json",
                    R"({"id":2147483647,)" + record + "null}");
  test::CaseApi api({}, folder / "case");
  EXPECT_EQ(api.call_api("GET", "/case").status, 200);
  EXPECT_EQ(api.call_api("GET", "/plan/poses").status, 422);
  EXPECT_EQ(json::parse(api.call_api("POST", "/jobs", R"({"kind":"cut"})").text)["id"], 1);
}

TEST(CaseApi, ErrorsDoNotContainTheFolderOfTheCase) {
  test::CaseApi api;
  // A folder in the way of each file, so that it cannot be written.
  for (const char* name : {"plan.json", "landmarks.mrk.json"})
    fs::create_directories(api.folder / "case" / name / "in the way");
  for (const Response& reply : {api.put("/plan", test::small_plan()),
                                api.put("/landmarks", {{"landmarks", {{"N", {1, 2, 3}}}}})}) {
    EXPECT_EQ(reply.status, 507) << reply.text;
    EXPECT_EQ(reply.text.find(api.folder.path().string()), std::string::npos) << reply.text;
  }
}

TEST(CaseApi, EightClientsReadLabelsAtOnce) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.run({{"kind", "segment"}})["state"], "done");
  const std::string labels = body_of(api.call_api("GET", "/labels/data"));
  std::atomic<int> wrong = 0;
  std::vector<std::thread> clients;
  for (int client = 0; client < 8; ++client)
    clients.emplace_back([&, client] {
      for (int n = 0; n < 100; ++n) {
        if (client == 0) {  // A wrong file among the good ones.
          const Response reply =
              api.call_api("PUT", "/boundary/file", "NRRD0004\n" + std::string(2000, 'A'),
                           {{"if-match", "*"}, {"content-type", "application/octet-stream"}});
          if (reply.status != 422) ++wrong;
        } else if (body_of(api.call_api("GET", "/labels/data")) != labels) {
          ++wrong;
        }
      }
    });
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(wrong, 0);
}

/// The page knows the new keys only.
TEST(CaseApi, APlanWithDeprecatedKeysIsReadWithTheNewOnes) {
  test::CaseApi api;
  json plan = test::small_plan();
  plan["boundary"] = {{"release_mm", 5.0}, {"moved_bone", "attached"}};
  const Response stored = api.put("/plan", plan);
  ASSERT_EQ(stored.status, 200) << stored.text;
  const json read = json::parse(body_of(api.call_api("GET", "/plan")));
  EXPECT_EQ(read["boundary"], json({{"elevation_margin_mm", 5.0}, {"interface", "bonded"}}));
  EXPECT_EQ(read["segments"], plan["segments"]);
  ASSERT_EQ(api.put("/plan", read).status, 200);
  EXPECT_EQ(json::parse(body_of(api.call_api("GET", "/plan"))), read);
}

TEST(CaseApi, APlanNamesNoFileOutsideTheCase) {
  test::CaseApi api;
  std::ofstream(api.folder / "secret.csv") << "name,x_mm,y_mm,z_mm\nSECRET,1,2,3\n";
  const auto put = [&](const std::function<void(json&)>& change) {
    json plan = test::small_plan();
    change(plan);
    return api.put("/plan", plan);
  };
  EXPECT_EQ(put([](json&) {}).status, 200);
  const std::string before = body_of(api.call_api("GET", "/plan"));
  for (const std::string& name :
       {std::string("../secret.csv"), (api.folder / "secret.csv").string(),
        std::string("/etc/passwd"), std::string("anatomy/../../secret.csv"),
        std::string("landmarks.mrk.json/../../secret.csv"), std::string("%2e%2e/secret.csv"),
        std::string("file:///etc/passwd"), std::string("jobs/1.json")}) {
    const auto refused = [&](const std::function<void(json&)>& change) {
      const Response reply = put(change);
      EXPECT_EQ(reply.status, 422) << name << reply.text;
      EXPECT_EQ(reply.text.find("SECRET"), std::string::npos);
    };
    refused([&](json& plan) { plan["landmarks"] = name; });
    refused([&](json& plan) { plan["ct"] = name; });
    refused([&](json& plan) { plan["segmentation"]["labels"] = name; });
    refused([&](json& plan) { plan["boundary"]["labels"] = name; });
    refused([&](json& plan) {
      plan["segments"][0]["osteotomy"]["curves"] = {{{"file", name}, {"along", {0, 1, 0}}}};
    });
    refused([&](json& plan) { plan["segments"][0]["osteotomy"]["planes"] = {{{"file", name}}}; });
    refused([&](json& plan) {
      plan["segments"][0]["osteotomy"]["additional_regions"] = {
          {{"curves", {{{"file", name}, {"along", {0, 1, 0}}}}}}};
    });
    refused([&](json& plan) {  // By its deprecated name.
      plan["segments"][0]["osteotomy"]["also"] = {
          {{"curves", {{{"file", name}, {"along", {0, 1, 0}}}}}}};
    });
    refused([&](json& plan) { plan["segments"][0]["path"]["keyframes"] = {{{"targets", name}}}; });
    refused([&](json& plan) {
      plan["segments"][0]["path"]["keyframes"] = {{{"transform", name}}};
    });
  }
  // Nor one of the case's own in the place of another, or before there is one.
  for (const char* name : {"anatomy/labels.seg.nrrd", "landmarks.mrk.json", "boundary.seg.nrrd"})
    EXPECT_EQ(put([&](json& plan) { plan["boundary"]["labels"] = name; }).status, 422) << name;
  EXPECT_EQ(put([](json& plan) { plan["segmentation"]["labels"] = "boundary.seg.nrrd"; }).status,
            422);
  // Nor by a key that stands twice, which parsers read in two ways.
  std::string twice = test::small_plan().dump();
  twice.insert(1, R"("landmarks":"/etc/passwd","landmarks":{"N":[1,2,3]},)");
  EXPECT_EQ(api.call_api("PUT", "/plan", twice, {{"if-match", "*"}}).status, 422);
  EXPECT_EQ(body_of(api.call_api("GET", "/plan")), before);
}

TEST(CaseApi, OnePageDoesNotOverwriteWhatAnotherWrote) {
  test::CaseApi api;
  const std::string plan = test::small_plan().dump();
  EXPECT_EQ(api.call_api("PUT", "/plan", plan).status, 428);
  EXPECT_EQ(api.call_api("PUT", "/plan", plan, {{"if-match", "\"0\""}}).status, 412);
  const Response first = api.call_api("PUT", "/plan", plan, {{"if-match", "*"}});
  ASSERT_EQ(first.status, 200);
  const std::string etag = first.headers.front().second;
  const std::string other = test::small_plan().dump(1);
  EXPECT_EQ(api.call_api("PUT", "/plan", other, {{"if-match", etag}}).status, 200);
  EXPECT_EQ(api.call_api("PUT", "/plan", plan, {{"if-match", etag}}).status, 412);
  EXPECT_EQ(body_of(api.call_api("GET", "/plan")), other);
  EXPECT_EQ(api.call_api("GET", "/plan", "", {{"if-none-match", etag}}).status, 200);
}

TEST(CaseApi, LabelsOfAReplacedScanAreRejected) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  image::CtVolume other = test::small_head();
  other.values[0] = 7;
  const auto put = [&](const std::function<void()>& meanwhile) {
    const std::string body(other.values.size(), '\0');
    Request request =
        test::api_request("PUT", "/labels/data", body,
                          {{"if-match", "*"}, {"content-type", "application/octet-stream"}});
    request.read_body = [body, meanwhile](const BodyTaker& take) {
      meanwhile();
      return take(body);
    };
    return api.api.handle(request).status;
  };
  EXPECT_EQ(put([&] { ASSERT_TRUE(io::write_volume(api.folder / "case/ct.nrrd", other)); }), 409);
  EXPECT_FALSE(fs::exists(api.folder / "case/anatomy/labels.seg.nrrd"));
  EXPECT_EQ(put(nothing), 204);
}

TEST(CaseApi, FilesAndSurfacesComeFromFixedLists) {
  test::CaseApi api;
  ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);
  EXPECT_EQ(api.call_api("GET", "/files/plan.json").status, 200);
  for (const char* path : {"/files/..%2fplan.json",
                           "/files/../plan.json",
                           "/files//etc/passwd",
                           "/files/.",
                           "/files/",
                           "/files/..",
                           "/files/lock",
                           "/files/stages.json",
                           "/files/jobs",
                           "/surfaces/../plan.json",
                           "/surfaces/segments/..",
                           "/surfaces/segments/../../plan",
                           "/surfaces/segments/",
                           "//case",
                           "/case/",
                           "/jobs/0",
                           "/jobs/-1",
                           "/jobs/1e1",
                           "/jobs/99999999999999999999",
                           ""})
    EXPECT_EQ(api.call_api("GET", path).status, 404) << path;
  EXPECT_EQ(api.call_api("DELETE", "/plan").status, 405);
}

TEST(CaseApi, AFailedJobMakesNoOlderResultFresh) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  json plan = test::small_plan();
  plan["segments"].push_back(plan["segments"][0]);
  plan["segments"][1]["name"] = "other";
  ASSERT_EQ(api.put("/plan", plan).status, 200);
  const fs::path preview = api.folder / "case/preview", prediction = api.folder / "case/prediction";
  for (const fs::path& file :
       {preview / "preview.json", prediction / "prediction.json", prediction / "failure.json"}) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "{}";
  }
  for (const auto& [kind, stage] : std::vector<std::pair<std::string, std::string>>{
           {"preview-factor", "preview"}, {"predict", "prediction"}}) {
    EXPECT_EQ(api.run({{"kind", kind}})["state"], "failed");
    EXPECT_EQ(api.get("/case")["stages"][stage]["state"], "failed") << stage;
  }
  EXPECT_EQ(api.call_api("GET", "/prediction").status, 404);
  EXPECT_FALSE(fs::exists(preview / "preview.json"));
}

/// Whether events report the iterations of the document, each before the end of its step, and match
/// the contract.
void expect_iterates_reported(const std::string& events, const json& document) {
  std::vector<double> reported, held;
  std::size_t newton = 0, steps = 0;
  for (std::size_t at = 0; at < events.size();) {
    const std::size_t end = events.find("\n\n", at);
    const std::string event = events.substr(at, end - at);
    at = end + 2;
    const std::string data = event.substr(event.find("\ndata: ") + 7);
    if (event.find("event: newton") != std::string::npos) {
      ++newton;
      EXPECT_TRUE(parse_by_contract(data, "NewtonEvent")) << data;
      const json batch = json::parse(data);
      for (const json& iterate : batch["iterates"]) {
        EXPECT_EQ(iterate["step"], steps + 1);
        reported.push_back(iterate["residual_n"]);
      }
    } else if (event.find("event: step") != std::string::npos) {
      ++steps;
      EXPECT_TRUE(parse_by_contract(data, "StepEvent")) << data;
      EXPECT_GT(newton, 0U);
    }
  }
  for (const json& step : document["steps"])
    for (const json& attempt : step["attempts"])
      for (const json& line : attempt["newton"]) held.push_back(line["residual_n"]);
  EXPECT_EQ(reported, held);
  EXPECT_EQ(steps, document["steps"].size());
}

/// The history for a page that connects late has the content and the numbers of the events.
void expect_history(const std::string& events, const json& history) {
  EXPECT_EQ(history["from"], 0);
  json iterates = json::array(), steps = json::array();
  for (std::size_t at = events.find("\ndata: "); at != std::string::npos;
       at = events.find("\ndata: ", at + 1)) {
    const json data = json::parse(events.substr(at + 7, events.find('\n', at + 1) - at - 7));
    if (data.contains("iterates")) {
      EXPECT_EQ(data["from"], iterates.size());
      for (const json& iterate : data["iterates"]) iterates.push_back(iterate);
    } else if (data.contains("path_fraction")) {
      steps.push_back(data);
    }
  }
  EXPECT_GT(iterates.size(), 5U);
  EXPECT_EQ(history["iterates"], iterates);
  EXPECT_EQ(history["steps"], steps);
}

TEST(SolveHistory, KeepsTheNewestAndCountsTheRemovedOnes) {
  SolveHistory history;
  EXPECT_FALSE(history.of(1));
  history.begin(1);
  EXPECT_EQ(history.add_iterates(json::array({0, 1, 2})), 0U);
  json many = json::array();
  for (std::size_t n = 3; n < SolveHistory::kMaxIterates + 2; ++n) many.push_back(n);
  EXPECT_EQ(history.add_iterates(many), 3U);
  const json now = history.of(1).value();
  EXPECT_EQ(now["from"], 2);
  EXPECT_EQ(now["iterates"].size(), SolveHistory::kMaxIterates);
  EXPECT_EQ(now["iterates"][0], 2);
  EXPECT_EQ(history.add_iterates(json::array({7})), SolveHistory::kMaxIterates + 2);
  history.begin(2);
  EXPECT_FALSE(history.of(1));
  EXPECT_TRUE(history.of(2)->at("iterates").empty());
}

/// Paints a ball about the front of the small head.
Response paint(test::CaseApi& api, char label, const char* if_match = "*") {
  constexpr int kSide = 12;
  std::string bytes(kSide * kSide * kSide, '\0');
  for (int n = 0; n < std::ssize(bytes); ++n) {
    const int i = n % kSide - 6, j = n / kSide % kSide - 6, k = n / (kSide * kSide) - 6;
    if (i * i + j * j + k * k < 30) bytes[std::size_t(n)] = label;
  }
  Request request =
      test::api_request("PUT", "/boundary/data", bytes,
                        {{"if-match", if_match}, {"content-type", "application/octet-stream"}});
  request.query["box"] = fmt::format("12,2,12,{0},{0},{0}", kSide);
  return api.api.handle(request);
}

/// \returns how many files the page's prediction and the command line's have alike.
int expect_the_command_lines_bytes(const fs::path& root) {
  const auto run =
      test::run_lefort("predict '" + (root / "plan.json").string() + "' --ct '" +
                       (root / "ct.nrrd").string() + "' -o '" + (root / "again").string() + "'");
  EXPECT_EQ(run.exit_code, 0) << run.error;
  int compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root / "again")) {
    const fs::path name = fs::relative(entry.path(), root / "again");
    if (!entry.is_regular_file() || *name.begin() == "cache") continue;
    std::string a = io::read_text(entry.path(), 1 << 30).value();
    std::string b = io::read_text(root / "prediction" / name, 1 << 30).value();
    if (name == "report.html") continue;  // It has run times, as prediction.json.
    if (name == "prediction.json") {
      json one = json::parse(a), two = json::parse(b);
      one.erase("timing");
      two.erase("timing");
      a = one.dump(), b = two.dump();
    }
    EXPECT_EQ(a, b) << name;
    ++compared;
  }
  return compared;
}

/// The planner and the command line use the same folder.
TEST(CaseApi, PredictsTheBytesOfTheCommandLine) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);
  std::uint64_t heard = api.api.events().now();
  const json job = api.run({{"kind", "predict"}});
  ASSERT_EQ(job["state"], "done") << job.dump(1);
  const std::string reported = api.api.events().wait(heard, milliseconds(0));
  expect_iterates_reported(reported, api.get("/prediction")["document"]);
  const std::string id = std::to_string(job["id"].get<int>());
  expect_history(reported, api.get("/jobs/" + id + "/iterates"));
  EXPECT_EQ(api.call_api("GET", "/jobs/99/iterates").status, 404);
  EXPECT_GT(expect_the_command_lines_bytes(api.folder / "case"), 10);
}

/// Expects that surface `interface` has as many vertices of each condition and rule as the groups.
void expect_interface_of_groups(test::CaseApi& api, const json& boundary) {
  std::map<std::string, int> value_of;
  for (const char* kind : {"conditions", "rules"})
    for (const json& one : boundary[kind])
      value_of[kind + one["name"].get<std::string>()] = one["value"];
  std::map<std::pair<int, int>, std::size_t> expected, found;
  std::size_t nodes = 0;
  for (const json& group : boundary["map"]["groups"]) {
    const std::size_t count = group["nodes"];
    nodes += count;
    expected[{value_of.at("conditions" + group["condition"].get<std::string>()),
              value_of.at("rules" + group["rule"].get<std::string>())}] += count;
  }
  const Response reply = api.call_api("GET", "/surfaces/interface");
  ASSERT_EQ(reply.status, 200) << reply.text;
  const std::string bytes = body_of(reply);
  std::array<std::uint32_t, 3> head{};
  std::memcpy(head.data(), bytes.data() + 8, sizeof(head));
  ASSERT_EQ(head[0], nodes);
  ASSERT_EQ(head[2], 2U);
  ASSERT_EQ(bytes.size(), 20 + 12 * std::size_t(head[0]) + 12 * std::size_t(head[1]) + 8 * nodes);
  std::vector<float> scalars(2 * nodes);
  std::memcpy(scalars.data(), bytes.data() + bytes.size() - 8 * nodes, 8 * nodes);
  for (std::size_t n = 0; n < nodes; ++n) ++found[{int(scalars[n]), int(scalars[nodes + n])}];
  EXPECT_EQ(found, expected);
}

TEST(CaseApi, ServesTheInterfaceMapOfThePresentPlan) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.run({{"kind", "segment"}})["state"], "done");
  json plan = test::small_plan();
  ASSERT_EQ(api.put("/plan", plan).status, 200);
  ASSERT_EQ(api.run({{"kind", "cut"}})["state"], "done");
  const auto expect_none = [&] {
    EXPECT_TRUE(api.get("/boundary")["map"].is_null());
    EXPECT_EQ(api.call_api("GET", "/surfaces/interface").status, 404);
    EXPECT_EQ(api.get("/surfaces").dump().find("interface"), std::string::npos);
  };
  expect_none();
  ASSERT_EQ(api.run({{"kind", "preview-factor"}})["state"], "done");
  const json boundary = api.get("/boundary");
  EXPECT_EQ(boundary["map"]["stage"], "preview");
  EXPECT_NE(boundary["map"]["groups"].dump().find("\"segment\":\"front\""), std::string::npos);
  EXPECT_NE(api.get("/surfaces").dump().find("interface"), std::string::npos);
  expect_interface_of_groups(api, boundary);

  plan["boundary"] = {{"interface", "contact"}};  // Makes the preview stale.
  ASSERT_EQ(api.put("/plan", plan).status, 200);
  expect_none();
  ASSERT_EQ(api.run({{"kind", "predict"}})["state"], "done");
  const json predicted = api.get("/boundary");
  EXPECT_EQ(predicted["map"]["stage"], "prediction");
  EXPECT_NE(predicted["map"]["groups"], boundary["map"]["groups"]);
  expect_interface_of_groups(api, predicted);
}

/// What is painted through the API is what the command line reads, and changes the face.
TEST(CaseApi, APaintedBoundaryIsThatOfTheCommandLine) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.run({{"kind", "segment"}})["state"], "done");
  json plan = test::with_paper_boundary(test::small_plan());
  ASSERT_EQ(api.put("/plan", plan).status, 200);
  ASSERT_EQ(api.run({{"kind", "cut"}})["state"], "done");
  ASSERT_EQ(api.run({{"kind", "preview-factor"}})["state"], "done");
  ASSERT_EQ(api.run({{"kind", "predict"}})["state"], "done");
  const std::string pose = R"({"poses":{"front":[1,0,0,0,0,1,0,-2,0,0,1,0,0,0,0,1]}})";
  const std::string by_rule = body_of(api.call_api("GET", "/files/predicted_skin.vtp"));
  const std::string preview = body_of(api.call_api("POST", "/preview", pose));
  EXPECT_TRUE(api.get("/boundary")["map"]["painted"].empty());

  constexpr char kWithSegment = 3;
  ASSERT_EQ(paint(api, kWithSegment).status, 204);
  EXPECT_EQ(api.get("/case")["stages"]["prediction"]["state"], "fresh");  // No plan names it.
  plan["boundary"]["labels"] = "boundary.seg.nrrd";
  ASSERT_EQ(api.put("/plan", plan).status, 200);
  json stages = api.get("/case")["stages"];
  EXPECT_EQ(stages["prediction"]["state"], "stale");
  EXPECT_EQ(stages["preview"]["state"], "stale");
  EXPECT_EQ(stages["cut"]["state"], "fresh");
  EXPECT_TRUE(api.get("/boundary")["map"].is_null());
  ASSERT_EQ(api.run({{"kind", "preview-factor"}})["state"], "done");
  EXPECT_NE(body_of(api.call_api("POST", "/preview", pose)), preview);
  const json map = api.get("/boundary")["map"];
  EXPECT_EQ(map["stage"], "preview");
  double with_segment_mm2 = 0.0;
  for (const json& label : map["painted"])
    if (label["name"] == "with segment") with_segment_mm2 = label["area_mm2"].get<double>();
  EXPECT_GT(with_segment_mm2, 10.0);
  const json job = api.run({{"kind", "predict"}});
  ASSERT_EQ(job["state"], "done") << job.dump(1);
  EXPECT_NE(body_of(api.call_api("GET", "/files/predicted_skin.vtp")), by_rule);
  EXPECT_GT(expect_the_command_lines_bytes(api.folder / "case"), 10);

  // Another stroke of the brush makes stale what was made of the one before, but no cut.
  ASSERT_EQ(paint(api, 1).status, 204);
  stages = api.get("/case")["stages"];
  EXPECT_EQ(stages["prediction"]["state"], "stale");
  EXPECT_EQ(stages["prediction"]["why"], "boundary.seg.nrrd changed after this was computed");
  EXPECT_EQ(stages["preview"]["state"], "stale");
  EXPECT_EQ(stages["cut"]["state"], "fresh");
  ASSERT_EQ(paint(api, kWithSegment).status, 204);  // As it was: all that was made fits again.
  EXPECT_EQ(api.get("/case")["stages"]["prediction"]["state"], "fresh");
  EXPECT_EQ(api.get("/case")["stages"]["preview"]["state"], "fresh");
}

/// Which of the two it has read is not known, so it is of neither.
TEST(CaseApi, PaintingDuringAJobMakesItsResultStale) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.run({{"kind", "segment"}})["state"], "done");
  ASSERT_EQ(paint(api, 3).status, 204);
  json plan = test::small_plan();
  plan["boundary"]["labels"] = "boundary.seg.nrrd";
  ASSERT_EQ(api.put("/plan", plan).status, 200);
  const int id =
      json::parse(api.call_api("POST", "/jobs", R"({"kind":"preview-factor"})").text)["id"];
  const std::string path = "/jobs/" + std::to_string(id);
  while (api.get(path)["stage"] == "") std::this_thread::sleep_for(milliseconds(2));
  ASSERT_EQ(paint(api, 1).status, 204);
  const bool is_amid = api.get(path)["state"] == "running";
  ASSERT_EQ(api.wait_for(id)["state"], "done");
  ASSERT_EQ(paint(api, 3).status, 204);
  if (is_amid) {  // Else it was quicker than this test.
    EXPECT_EQ(api.get("/case")["stages"]["preview"]["state"], "stale");
  }
}

TEST(CaseApi, PaintIsReplacedOnlyWithItsVersion) {
  test::CaseApi api;
  const auto send = [&](const std::string& method, const std::string& path, std::string body,
                        const std::string& box = "", const std::string& if_match = "*") {
    Request request =
        test::api_request(method, path, std::move(body),
                          {{"if-match", if_match}, {"content-type", "application/octet-stream"}});
    if (!box.empty()) request.query["box"] = box;
    return api.api.handle(request);
  };
  EXPECT_EQ(paint(api, 1).status, 404);  // The case has no scan.
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  EXPECT_EQ(api.call_api("GET", "/boundary/data").status, 404);
  ASSERT_EQ(paint(api, 1).status, 204);
  const Response reply = api.call_api("GET", "/boundary/data");
  const std::string kept = body_of(reply);
  std::string etag, box;
  for (const auto& [name, value] : reply.headers)
    (name == "ETag" ? etag : name == "X-Lefort-Box" ? box : etag) = value;
  EXPECT_EQ(box, "13,3,13,11,11,11");  // The smallest that holds the ball.
  EXPECT_EQ(std::count(kept.begin(), kept.end(), '\1'), 691);
  EXPECT_EQ(paint(api, 2, "\"0\"").status, 412);
  EXPECT_EQ(paint(api, 2, "").status, 428);
  EXPECT_EQ(send("PUT", "/boundary/data", kept, box, etag).status, 204);
  EXPECT_EQ(body_of(api.call_api("GET", "/boundary/data")), kept);  // And so is the file.
  EXPECT_EQ(api.call_api("GET", "/boundary/data", "", {{"if-none-match", etag}}).status, 304);

  for (const char* wrong : {"", "0,0,0,1,1", "0,0,0,1,1,1,1", "-1,0,0,2,1,1", "0,0,0,0,1,1",
                            "36,0,0,1,1,1", "0,0,0,37,1,1", "0,0,0,1,1,1 ", "0,0,0,1,1,x",
                            "1,0,0,9223372036854775807,1,1", "99999999999999999999,0,0,1,1,1"})
    EXPECT_EQ(send("PUT", "/boundary/data", "\1", wrong).status, 422) << wrong;
  EXPECT_EQ(send("PUT", "/boundary/data", "\1\1", "0,0,0,1,1,1").status, 413);
  EXPECT_EQ(send("PUT", "/boundary/data", "\1", "0,0,0,2,1,1").status, 422);
  EXPECT_EQ(send("PUT", "/boundary/data", "\10", "0,0,0,1,1,1").status, 422);
  EXPECT_EQ(send("PUT", "/boundary/data", std::string(1, '\0'), "0,0,0,1,1,1").status, 422);
  EXPECT_EQ(body_of(api.call_api("GET", "/boundary/data")), kept);

  // The file of another program, and what is none.
  const std::string file = body_of(api.call_api("GET", "/files/boundary.seg.nrrd"));
  ASSERT_EQ(paint(api, 2).status, 204);
  EXPECT_EQ(send("PUT", "/boundary/file", file).status, 204);
  EXPECT_EQ(body_of(api.call_api("GET", "/files/boundary.seg.nrrd")), file);
  for (const std::string& wrong : {std::string("NRRD0004\n"), file.substr(0, file.size() / 2),
                                   std::string(), std::string("/etc/passwd")}) {
    const Response refused = send("PUT", "/boundary/file", wrong);
    EXPECT_EQ(refused.status, 422) << refused.text;
    EXPECT_EQ(refused.text.find(api.folder.path().string()), std::string::npos) << refused.text;
  }
  EXPECT_EQ(body_of(api.call_api("GET", "/files/boundary.seg.nrrd")), file);
  EXPECT_TRUE(fs::is_empty(api.folder / "case/uploads"));

  // It goes when no plan names it.
  json plan = test::small_plan();
  plan["boundary"]["labels"] = "boundary.seg.nrrd";
  ASSERT_EQ(api.put("/plan", plan).status, 200);
  EXPECT_EQ(send("DELETE", "/boundary/data", "").status, 409);
  ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);
  EXPECT_EQ(send("DELETE", "/boundary/data", "", "", "\"0\"").status, 412);
  EXPECT_EQ(send("DELETE", "/boundary/data", "").status, 204);
  EXPECT_EQ(send("DELETE", "/boundary/data", "").status, 404);
  EXPECT_EQ(api.get("/case")["stages"]["boundary"]["state"], "missing");
}

/// Stopped by its page and started again, it ends with the same bytes.
TEST(CaseApi, ACancelledPredictionResumes) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);
  ASSERT_EQ(api.run({{"kind", "predict"}})["state"], "done");
  const std::string whole = body_of(api.call_api("GET", "/files/predicted_skin.vtp"));
  fs::remove_all(api.folder / "case/prediction");

  std::uint64_t heard = api.api.events().now();
  const int id = json::parse(api.call_api("POST", "/jobs", R"({"kind":"predict"})").text)["id"];
  std::string reported;
  while (reported.find("event: step") == std::string::npos &&
         reported.find("\"state\":\"done\"") == std::string::npos)
    reported += api.api.events().wait(heard, milliseconds(1000));
  EXPECT_EQ(api.call_api("DELETE", "/jobs/" + std::to_string(id)).status, 200);
  const json stopped = api.wait_for(id);
  if (stopped["state"] == "cancelled") {  // It may have been at its end.
    EXPECT_EQ(api.get("/case")["stages"]["prediction"]["state"], "missing");
  }
  const json again = api.run({{"kind", "predict"}});
  ASSERT_EQ(again["state"], "done");
  EXPECT_NE(again["lines"].dump().find("were computed by an earlier run"), std::string::npos);
  // Its history begins with what the earlier run found, each step once.
  const json history = api.get("/jobs/" + std::to_string(again["id"].get<int>()) + "/iterates");
  ASSERT_EQ(history["steps"].size(), 2U);
  for (int step : {1, 2}) EXPECT_EQ(history["steps"][std::size_t(step - 1)]["step"], step);
  EXPECT_EQ(body_of(api.call_api("GET", "/files/predicted_skin.vtp")), whole);
}

}  // namespace
}  // namespace lefort::server::test_server_jobs
