/// \file
/// Thousands of damaged requests: to the API directly, and over sockets as bytes.
///
/// Every response conforms to the contract, the server continues, and nothing changes except what
/// was requested. Seeded; limited in number and time.
#include <lefort/io/read_text.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/server/api/contract.h>
#include <lefort/server/http/http_server.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "fuzz/damaged.h"
#include "support/serve_here.h"
#include "support/small_head.h"

namespace lefort::server::test_fuzz_server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::string_view kTokens[] = {"../",
                                        "/",
                                        "%2e%2e%2f",
                                        "%00",
                                        "\\..\\",
                                        "/etc/passwd",
                                        "null",
                                        "-1",
                                        "1e308",
                                        "1e999",
                                        "99999999999999999999",
                                        "[]",
                                        "{}",
                                        "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[",
                                        "\"\"",
                                        "\"kind\":",
                                        "\xff\xfe",
                                        "\r\n",
                                        "\r\n\r\n",
                                        "Content-Length: 5\r\n",
                                        "Transfer-Encoding: chunked\r\n",
                                        "Host: evil\r\n",
                                        " HTTP/1.1\r\n",
                                        "segments",
                                        "front",
                                        "plan.json"};

/// Valid requests, before damage. None starts a long job.
struct Asked {
  const char* method;
  std::string path, body;
};

/// A file of painted boundaries on the small head.
std::string painted_file() {
  predict::BoundaryLabelMap painted{test::small_head().grid, {}};
  painted.grid.size = {3, 3, 3};
  painted.values.assign(27, predict::BoundaryLabel::kFixed);
  const test::TemporaryFolder folder;
  EXPECT_TRUE(io::write_boundary_labels(folder / "a.seg.nrrd", painted));
  return io::read_text(folder / "a.seg.nrrd", 1 << 20).value();
}

std::vector<Asked> some_requests() {
  const std::string pose = R"({"poses":{"front":[1,0,0,0,0,1,0,3,0,0,1,0,0,0,0,1]}})";
  return {{"GET", "/case", ""},
          {"GET", "/jobs/1", ""},
          {"GET", "/surfaces/skin", ""},
          {"GET", "/surfaces/segments/front", ""},
          {"GET", "/files/plan.json", ""},
          {"GET", "/prediction/steps/1", ""},
          {"GET", "/plan/poses", ""},
          {"POST", "/jobs", R"({"kind":"import","upload":"0123456789abcdef"})"},
          {"PUT", "/plan", test::small_plan().dump()},
          {"PUT", "/landmarks", R"({"landmarks":{"N":[0,-47,20],"A":[0,-47,-10]}})"},
          {"POST", "/measurements", R"({"before":{"N":[0,-47,20],"A":[0,-47,-10],"S":[0,1,2]}})"},
          {"POST", "/osteotomies",
           R"({"template":{"kind":"le-fort-1"},"landmarks":{"ANS":[0,-40,0],"PNS":[0,0,0]}})"},
          {"POST", "/poses", pose},
          {"POST", "/preview", pose},
          {"PUT", "/labels/data", std::string(100, '\1')},
          {"GET", "/boundary", ""},
          {"PUT", "/boundary/data", std::string(27, '\1')},
          {"PUT", "/boundary/file", painted_file()},
          {"DELETE", "/boundary/data", ""},
          {"GET", "/splints/final", ""},
          {"PUT", "/teeth/corrections",
           R"({"lefort_tooth_corrections":1,"corrections":[{"found":16,"fdi":17}]})"},
          {"PUT", "/nerve/points", R"({"points":{"MeF-L":[20,-50,-70],"IAN-R-2":[1,2,3]}})"},
          {"PUT", "/uploads/0123456789abcdef/files/0", "bytes"},
          {"DELETE", "/jobs/1", ""}};
}

/// All entries that a case folder may contain; nothing else may appear.
void expect_only_ours(const fs::path& folder) {
  const std::vector<std::string> ours{"ct.nrrd",
                                      "case.json",
                                      "anatomy",
                                      "landmarks.mrk.json",
                                      "plan.json",
                                      "cut",
                                      "jobs",
                                      "uploads",
                                      "lock",
                                      "stages.json",
                                      "prediction",
                                      "boundary.seg.nrrd",
                                      "teeth_corrections.json",
                                      "nerve_points.mrk.json"};
  for (const auto& entry : fs::directory_iterator(folder))
    EXPECT_NE(std::find(ours.begin(), ours.end(), entry.path().filename().string()), ours.end())
        << entry.path();
}

TEST(FuzzServer, DamagedRequestsToTheApi) {
  test::CaseApi api;
  ASSERT_EQ(api.import_volume(test::small_head())["state"], "done");
  ASSERT_EQ(api.put("/plan", test::small_plan()).status, 200);
  ASSERT_EQ(api.run({{"kind", "cut"}})["state"], "done");
  const auto requests = some_requests();
  int done = 0, refused = 0;
  test::run_seeds(1000, [&](unsigned seed) {
    std::mt19937 random(seed);
    Asked requested = requests[seed % requests.size()];
    switch (seed / requests.size() % 3) {
      case 0:
        requested.path = "/" + test::damaged(requested.path.substr(1), kTokens, random);
        break;
      case 1:
        requested.body = test::damaged(requested.body, kTokens, random);
        break;
      default: {  // Replaces a value; the result may still be JSON.
        const std::size_t at =
            requested.body.empty()
                ? std::string::npos
                : requested.body.find_first_of(":[,", random() % requested.body.size());
        if (at == std::string::npos) return;
        const std::size_t end =
            std::min(requested.body.find_first_of(",]}", at + 1), requested.body.size());
        requested.body.replace(at + 1, end - at - 1, kTokens[random() % std::size(kTokens)]);
      }
    }
    const char* const type =
        requested.path.starts_with("/boundary") ? "application/octet-stream" : "application/json";
    Request request = test::api_request(requested.method, requested.path, requested.body,
                                        {{"if-match", "*"}, {"content-type", type}});
    std::string box = "1,2,3,3,3,3";
    if (random() % 2 == 0) box = test::damaged(box, kTokens, random);
    request.query = {{"name", "a"}, {"count", requested.body.substr(0, 4)}, {"box", box}};
    const Response reply = api.api.handle(request);
    ASSERT_NE(reply.status, 500) << requested.method << requested.path << requested.body;
    if (reply.status >= 400) {
      ++refused;
      ASSERT_TRUE(parse_by_contract(reply.text, "Error")) << reply.text;
      ASSERT_EQ(reply.text.find("root:"), std::string::npos);
      ASSERT_EQ(reply.text.find(api.folder.path().string()), std::string::npos) << reply.text;
    } else {
      ++done;
    }
  });
  EXPECT_GT(done, 5);
  EXPECT_GT(refused, 5);
  expect_only_ours(api.folder / "case");
  EXPECT_EQ(api.call_api("GET", "/case").status, 200);
}

TEST(FuzzServer, DamagedBytesOverSockets) {
  HttpLimits limits;
  limits.header_time = std::chrono::milliseconds(200);
  limits.stall_time = std::chrono::milliseconds(200);
  const test::Served served(limits);
  const auto requests = some_requests();
  int answered = 0;
  test::run_seeds(300, [&](unsigned seed) {
    std::mt19937 random(seed);
    const Asked& requested = requests[seed % requests.size()];
    std::string bytes =
        served.text(std::string(requested.method) + " /api/v1" + requested.path,
                    "Content-Type: application/json\r\nIf-Match: *\r\n", requested.body);
    bytes = test::damaged(bytes, kTokens, random);
    const test::Socket socket(served.port);
    socket.send(bytes);
    const std::string reply = socket.receive(3000);
    ASSERT_EQ(reply.find("root:"), std::string::npos);
    if (!reply.empty()) {
      ++answered;
      ASSERT_TRUE(reply.starts_with("HTTP/1.")) << reply;
      ASSERT_EQ(reply.find("HTTP/1.1 500"), std::string::npos) << bytes;
    }
  });
  EXPECT_GT(answered, 5);
  EXPECT_EQ(served.status("GET /api/v1/case"), 200);
}

}  // namespace
}  // namespace lefort::server::test_fuzz_server
