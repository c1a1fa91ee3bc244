/// \file
/// Security of the server: loopback only, limited connections and times.
#include <lefort/server/http/connection.h>
#include <lefort/server/http/http_server.h>
#include <lefort/server/http/page.h>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/serve_here.h"
#include "support/small_head.h"

namespace lefort::server::test_server_http {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::steady_clock;
using test::kToken;
using test::Served;
using test::Socket;

const std::string kJson = "Content-Type: application/json\r\n";

/// Resident memory of this process [MB].
double memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024.0;
  return 0.0;
}

long descriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

TEST(HttpServer, ServesThePageWithoutTokenAndTheCaseWithIt) {
  const Served served;
  const std::string page = served.call_api("GET /", "", "", false);
  EXPECT_EQ(Served::status_of(page), 200);
  for (const char* header :
       {"Content-Security-Policy: default-src 'none'", "X-Content-Type-Options: nosniff",
        "Referrer-Policy: no-referrer", "X-Frame-Options: DENY"})
    EXPECT_NE(page.find(header), std::string::npos) << header;
  EXPECT_EQ(page.find(kToken), std::string::npos);
  EXPECT_EQ(Served::status_of(served.call_api("DELETE /", "", "", false)), 405);
  const std::string answer = served.call_api("GET /api/v1/case");
  EXPECT_EQ(Served::status_of(answer), 200);
  EXPECT_NE(answer.find("Cache-Control: no-store"), std::string::npos);
  EXPECT_NE(answer.find("not for clinical use"), std::string::npos);
  EXPECT_EQ(answer.find("Access-Control"), std::string::npos);
}

TEST(HttpServer, RejectsRequestsWithoutTheToken) {
  Served served;
  std::string nearly = kToken;
  nearly.back() = '8';
  for (const std::string& headers :
       {std::string(), "X-Lefort-Token: " + nearly + "\r\n", std::string("X-Lefort-Token: \r\n"),
        "X-Lefort-Token: " + kToken + "7\r\n", "X-Lefort-Token: " + kToken.substr(1) + "\r\n",
        "X-Lefort-Token: " + kToken + "\r\nX-Lefort-Token: " + kToken + "\r\n",
        "Authorization: Bearer " + kToken + "\r\n", "Cookie: token=" + kToken + "\r\n"})
    for (const char* line : {"GET /api/v1/case", "GET /api/v1/events", "GET /api/v1/volume/data",
                             "HEAD /api/v1/case", "DELETE /api/v1/jobs/1", "GET /api/v1/nothing"})
      EXPECT_EQ(Served::status_of(served.call_api(line, headers, "", false)), 401)
          << line << headers;
  EXPECT_EQ(
      Served::status_of(served.call_api("POST /api/v1/jobs", kJson, R"({"kind":"cut"})", false)),
      401);
  EXPECT_EQ(Served::status_of(served.call_api("GET /api/v1/case?token=" + kToken, "", "", false)),
            401);
  EXPECT_TRUE(served.own.api.handle(test::api_request("GET", "/jobs")).text.find("cut") ==
              std::string::npos);
}

TEST(HttpServer, RejectsForeignOriginsAndHosts) {
  const Served served;
  for (const std::string& origin :
       {std::string("http://evil.example"), std::string("null"), std::string("http://127.0.0.1"),
        "https://" + served.host(), "http://" + served.host() + ".evil.example",
        "http://127.0.0.1:" + std::to_string(served.port + 1)})
    EXPECT_EQ(served.status("GET /api/v1/case", "Origin: " + origin + "\r\n"), 403) << origin;
  EXPECT_EQ(served.status("GET /api/v1/case", "Origin: http://" + served.host() + "\r\n"), 200);
  EXPECT_EQ(served.status("GET /api/v1/case",
                          "Origin: http://" + served.host() + "\r\nOrigin: http://evil\r\n"),
            403);
  EXPECT_EQ(served.status("GET /api/v1/case", "Sec-Fetch-Site: cross-site\r\n"), 403);
  // A name that an attacker's DNS points to us.
  const std::string port = std::to_string(served.port);
  for (const std::string& host : {"evil.example:" + port, std::string("127.0.0.1"),
                                  "127.0.0.1:" + std::to_string(served.port + 1),
                                  "127.0.0.1.evil.example:" + port, std::string()})
    for (const char* path : {"/", "/api/v1/case"})
      EXPECT_EQ(Served::status_of(served.exchange(
                    std::string("GET ") + path + " HTTP/1.1\r\nHost: " + host +
                    "\r\nX-Lefort-Token: " + kToken + "\r\nConnection: close\r\n\r\n")),
                421)
          << host;
  EXPECT_EQ(Served::status_of(served.exchange("GET /api/v1/case HTTP/1.1\r\nX-Lefort-Token: " +
                                              kToken + "\r\nConnection: close\r\n\r\n")),
            421);
  EXPECT_EQ(Served::status_of(
                served.exchange("GET /api/v1/case HTTP/1.1\r\nHost: localhost:" + port +
                                "\r\nX-Lefort-Token: " + kToken + "\r\nConnection: close\r\n\r\n")),
            200);
  EXPECT_EQ(served.status("OPTIONS /api/v1/case"), 405);
  EXPECT_EQ(served.status("TRACE /api/v1/case"), 405);
}

TEST(HttpServer, NoPathLeavesTheCaseOrThePage) {
  Served served;
  std::ofstream(served.own.folder / "secret.txt") << "SECRET";
  std::ofstream(served.own.folder / "case/secret.txt") << "SECRET";
  for (const std::string& path :
       {std::string("/../secret.txt"), std::string("/..%2fsecret.txt"),
        std::string("/%2e%2e/secret.txt"), std::string("/%252e%252e/secret.txt"),
        std::string("/api/v1/files/../../secret.txt"),
        std::string("/api/v1/files/..%2f..%2fsecret.txt"),
        std::string("/api/v1/files/%2e%2e%2fsecret.txt"), std::string("/api/v1/files/secret.txt"),
        std::string("/api/v1/files/..\\secret.txt"),
        "/api/v1/files/" + (served.own.folder / "secret.txt").string(),
        std::string("/api/v1/files//etc/passwd"), std::string("/api/v1/files/%2fetc%2fpasswd"),
        std::string("/api/v1/files/plan.json%00.txt"),
        std::string("/api/v1/surfaces/segments/%2e%2e"), std::string("//etc/passwd"),
        std::string("/assets/../../secret.txt"), std::string("/api/v1/../../secret.txt"),
        std::string("/%00"), std::string("/api/v1")}) {
    const std::string reply = served.call_api("GET " + path);
    const int status = Served::status_of(reply);
    EXPECT_TRUE(status == 404 || status == 400) << path << " " << status;
    EXPECT_EQ(reply.find("SECRET"), std::string::npos) << path;
    EXPECT_EQ(reply.find("root:"), std::string::npos) << path;
  }
}

TEST(HttpServer, RejectsBodiesWithoutOrBeyondTheirLength) {
  Served served;
  const double before_mb = memory_mb();
  EXPECT_EQ(served.status("POST /api/v1/jobs", kJson + "Transfer-Encoding: chunked\r\n"), 411);
  EXPECT_EQ(served.status("POST /api/v1/jobs", kJson), 411);
  EXPECT_EQ(served.status("PUT /api/v1/plan", kJson), 411);
  for (const char* length : {"-1", "+5", "0x10", "5, 5", "1e9", "999999999999999999999"})
    EXPECT_EQ(served.status("POST /api/v1/jobs",
                            kJson + "Content-Length: " + std::string(length) + "\r\n"),
              400)
        << length;
  EXPECT_EQ(
      served.status("POST /api/v1/jobs", kJson + "Content-Length: 3\r\nContent-Length: 5\r\n"),
      400);
  EXPECT_EQ(served.status("POST /api/v1/jobs", kJson + "Content-Length: 9999999999999\r\n"), 413);
  EXPECT_EQ(served.status("POST /api/v1/jobs", kJson + "Content-Length: 5000000\r\n"), 413);
  EXPECT_EQ(served.status("GET /api/v1/case", "Content-Length: 5\r\n"), 400);
  EXPECT_EQ(served.status("POST /api/v1/jobs", kJson + "Content-Encoding: gzip\r\n", "abc"), 415);
  EXPECT_EQ(served.status("POST /api/v1/jobs", "Content-Type: text/plain\r\n", "{}"), 415);
  EXPECT_EQ(served.status("POST /api/v1/jobs", "Content-Type: multipart/form-data; boundary=x\r\n",
                          "--x--"),
            415);
  EXPECT_EQ(served.status("POST /", kJson, "{}"), 405);
  // Large ones are refused whether or not they come.
  const std::string large(8 << 20, ' ');
  EXPECT_EQ(served.status("POST /api/v1/jobs", kJson, large), 413);
  const std::string id =
      json::parse(served.own.call_api("POST", "/uploads").text)["id"].get<std::string>();
  EXPECT_EQ(served.status("PUT /api/v1/uploads/" + id + "/files/0?name=x",
                          "Content-Length: 3000000000\r\n"),
            413);
  EXPECT_LT(memory_mb() - before_mb, 100.0);
}

/// Data after a rejected body are not read as a request.
TEST(HttpServer, PreventsRequestSmuggling) {
  const Served served;
  const std::string inner = "DELETE /api/v1/jobs/1 HTTP/1.1\r\nHost: " + served.host() +
                            "\r\nX-Lefort-Token: " + kToken + "\r\n\r\n";
  const std::string host = "Host: " + served.host() + "\r\nX-Lefort-Token: " + kToken + "\r\n";
  for (const std::string& outer :
       {"GET /api/v1/case HTTP/1.1\r\n" + host + "Content-Length: " + std::to_string(inner.size()) +
            "\r\n\r\n",
        "POST /api/v1/jobs HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\n",
        "POST /api/v1/nothing HTTP/1.1\r\n" + host + kJson +
            "Content-Length: " + std::to_string(inner.size()) + "\r\n\r\n",
        "POST /api/v1/jobs HTTP/1.1\r\n" + host + "Content-Type: text/plain\r\nContent-Length: " +
            std::to_string(inner.size()) + "\r\n\r\n"}) {
    const std::string reply = served.exchange(outer + inner);
    std::size_t replies = 0;
    for (std::size_t at = reply.find("HTTP/1.1 "); at != std::string::npos;
         at = reply.find("HTTP/1.1 ", at + 1))
      ++replies;
    EXPECT_EQ(replies, 1U) << reply;
  }
}

TEST(HttpServer, LimitsHeaders) {
  const Served served;
  const auto refused = [](int status) { return status == 0 || status >= 400; };
  EXPECT_TRUE(refused(served.status("GET /" + std::string(100'000, 'a'))));
  EXPECT_EQ(served.status("GET /api/v1/" + std::string(2000, 'a')), 414);
  EXPECT_TRUE(
      refused(served.status("GET /api/v1/case", "X: " + std::string(100'000, 'a') + "\r\n")));
  std::string many;
  for (int n = 0; n < 10'000; ++n) many += "X" + std::to_string(n) + ": 1\r\n";
  EXPECT_TRUE(refused(served.status("GET /api/v1/case", many)));
  for (const std::string& garbage :
       {std::string("\r\n\r\n"), std::string(5000, '\0'), std::string("GET\r\n\r\n"),
        std::string("GET / HTTP/9.9\r\n\r\n"), std::string("\x16\x03\x01\x02", 4) + "\r\n\r\n"})
    EXPECT_TRUE(refused(Served::status_of(served.exchange(garbage))));
  // A range is not a way to have much sent for little.
  std::string ranges = "Range: bytes=0-";
  for (int n = 0; n < 500; ++n) ranges += ",0-";
  EXPECT_LT(served.call_api("GET /", ranges + "\r\n").size(), 2'000'000U);
  EXPECT_EQ(served.status("GET /api/v1/case"), 200);
}

TEST(HttpServer, ServesOrRejectsAThousandConnections) {
  rlimit limit{};  // Both ends of each are this process's.
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &limit), 0);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 4096);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
  const long descriptors_before = descriptors();
  {
    const Served served;
    const double before_mb = memory_mb();
    std::vector<Socket> sockets;
    for (int n = 0; n < 1000; ++n) {
      sockets.emplace_back(served.port);
      ASSERT_TRUE(sockets.back().is_open()) << n;
      sockets.back().send(served.text("GET /api/v1/case"));
    }
    int served_count = 0, refused = 0;
    for (const Socket& socket : sockets) {
      const int status = Served::status_of(socket.receive(30000));
      ASSERT_TRUE(status == 200 || status == 503) << status;
      ++(status == 200 ? served_count : refused);
    }
    EXPECT_GT(served_count, 100);
    RecordProperty("served", std::to_string(served_count));
    std::cout << served_count << " served, " << refused << " refused\n";
    EXPECT_EQ(served.status("GET /api/v1/case"), 200);
    EXPECT_LT(memory_mb() - before_mb, 100.0);
  }
  EXPECT_LE(descriptors(), descriptors_before + 2);
}

TEST(HttpServer, ServesOthersWhileSomeAreSlow) {
  HttpLimits limits;
  limits.header_time = milliseconds(120'000);
  const Served served(limits);
  std::vector<Socket> slow;
  for (int n = 0; n < 400; ++n) {  // Each begins a request and does not end it.
    slow.emplace_back(served.port);
    slow.back().send("GET /api/v1/case HTTP/1.1\r\nHost: ");
  }
  const auto begin = steady_clock::now();
  EXPECT_EQ(served.status("GET /api/v1/case"), 200);
  EXPECT_LT(steady_clock::now() - begin, limits.header_time) << "answered after they timed out";
}

TEST(HttpServer, IdleTimeStartsWithEachRequest) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  {
    const HttpLimits limits;
    Connection kept_alive(ends[0], limits);
    std::this_thread::sleep_for(milliseconds(20));
    ASSERT_EQ(::send(ends[1], "G", 1, MSG_NOSIGNAL), 1);
    const auto now = Connection::Clock::now();
    EXPECT_TRUE(kept_alive.wait_for_request());
    EXPECT_TRUE(kept_alive.is_waiting());
    EXPECT_GE(kept_alive.since(), now);
  }
  ::close(ends[0]);
  ::close(ends[1]);
}

/// A connection and the other end of its socket.
struct ConnectedPair {
  ConnectedPair() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0); }
  ~ConnectedPair() {
    ::close(ends[0]);
    ::close(ends[1]);
  }
  ConnectedPair(const ConnectedPair&) = delete;
  ConnectedPair& operator=(const ConnectedPair&) = delete;
  int ends[2] = {-1, -1};
};

TEST(HttpServer, HidesRangesFromHttplib) {
  const HttpLimits limits;
  const std::string request =
      "GET /range: HTTP/1.1\r\nRange: bytes=0-1\r\nHost: a\r\nrAnGe:x\r\n"
      "X-Range: y\r\nRanger: z\r\n\r\n";
  const std::string expected =
      "GET /range: HTTP/1.1\r\nxange: bytes=0-1\r\nHost: a\r\nxAnGe:x\r\n"
      "X-Range: y\r\nRanger: z\r\n\r\n";
  for (const std::size_t at_once : {std::size_t{1}, std::size_t{3}, request.size()}) {
    const ConnectedPair pair;
    Connection connection(pair.ends[0], limits);
    std::jthread client([&] {
      for (std::size_t at = 0; at < request.size(); at += at_once)
        static_cast<void>(
            ::send(pair.ends[1], request.data() + at, std::min(at_once, request.size() - at), 0));
    });
    ASSERT_TRUE(connection.wait_for_request());
    std::string found;
    for (char c = 0; found.size() < request.size() && connection.read(&c, 1) == 1;) found += c;
    EXPECT_EQ(found, expected) << at_once;
  }
  // 7 kB of ranges, which httplib would match with as many nested calls.
  const Served served;
  std::string ranges = "Range: bytes=0-1";
  while (ranges.size() < 7000) ranges += ",0-1";
  EXPECT_EQ(served.status("GET /api/v1/case", ranges + "\r\n"), 200);
}

TEST(HttpServer, ClientsThatDoNotReadCanBeEvicted) {
  const HttpLimits limits;
  const ConnectedPair pair;
  Connection connection(pair.ends[0], limits);
  ASSERT_EQ(::send(pair.ends[1], "G", 1, 0), 1);
  ASSERT_TRUE(connection.wait_for_request());
  char c = 0;
  ASSERT_EQ(connection.read(&c, 1), 1);
  connection.begin_body();
  EXPECT_FALSE(connection.is_waiting());
  const auto begun = Connection::Clock::now();
  std::atomic<bool> is_ended = false;
  std::jthread reply([&] {
    const std::string bytes(1 << 16, 'x');
    while (connection.write(bytes.data(), bytes.size()) >= 0) {
    }
    is_ended = true;
  });
  while (!connection.is_waiting()) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_GE(connection.since(), begun + milliseconds(1000));  // Evicted a second later.
  EXPECT_FALSE(is_ended);
  connection.abort();
  reply.join();
  EXPECT_TRUE(is_ended);
  EXPECT_FALSE(connection.is_waiting());
}

TEST(HttpServer, EvictsSlowConnections) {
  HttpLimits limits;
  limits.header_time = milliseconds(300);
  limits.idle_time = milliseconds(300);
  limits.stall_time = milliseconds(300);
  const Served served(limits);
  const auto begin = steady_clock::now();
  // A header, a letter at a time.
  const Socket dripping(served.port);
  for (int n = 0; n < 100 && dripping.send("G"); ++n) std::this_thread::sleep_for(milliseconds(20));
  EXPECT_EQ(Served::status_of(dripping.receive(3000)) / 100 == 2, false);
  // A body that does not come, and one that comes in drops.
  const Socket silent(served.port);
  silent.send(served.text("POST /api/v1/jobs", kJson + "Content-Length: 100\r\n"));
  EXPECT_NE(Served::status_of(silent.receive(5000)), 202);
  const Socket drops(served.port);
  drops.send(served.text("POST /api/v1/jobs", kJson + "Content-Length: 100\r\n"));
  for (int n = 0; n < 100 && drops.send(" "); ++n) std::this_thread::sleep_for(milliseconds(20));
  EXPECT_NE(Served::status_of(drops.receive(5000)), 202);
  // A silent client.
  const Socket mute(served.port);
  EXPECT_EQ(mute.receive(5000), "");
  EXPECT_LT((steady_clock::now() - begin) / milliseconds(1), 15000);
  EXPECT_EQ(served.status("GET /api/v1/case"), 200);
}

TEST(HttpServer, ListenersCanDisconnectAndAreLimited) {
  HttpLimits limits;
  limits.listeners = 4;
  Served served(limits);
  const long descriptors_before = descriptors();
  const std::string listen = served.text("GET /api/v1/events");
  for (int round = 0; round < 5; ++round) {
    std::vector<Socket> pages;
    for (int n = 0; n < 4; ++n) {
      pages.emplace_back(served.port);
      pages.back().send(listen);
      EXPECT_NE(pages.back().receive(5000, "welcome").find("text/event-stream"), std::string::npos);
    }
    EXPECT_EQ(Served::status_of(served.call_api("GET /api/v1/events")), 429);
    pages.clear();  // They disconnect without notice.
    std::this_thread::sleep_for(milliseconds(1200));
  }
  EXPECT_LE(descriptors(), descriptors_before + 2);
}

TEST(HttpServer, SendsMissedEvents) {
  Served served;
  served.own.import_volume(test::small_head());
  const std::string start = served.own.api.events().start();
  const Socket page(served.port);
  page.send(served.text("GET /api/v1/events", "Last-Event-ID: " + start + ".0\r\n"));
  const std::string missed = page.receive(5000, "\"state\":\"done\"");
  EXPECT_NE(missed.find("id: " + start + ".1\n"), std::string::npos) << missed;
  EXPECT_NE(missed.find("\"state\":\"done\""), std::string::npos);
  const Socket stranger(served.port);
  stranger.send(served.text("GET /api/v1/events", "Last-Event-ID: 00000000.7\r\n"));
  EXPECT_NE(stranger.receive(5000, "event: reset").find("event: reset"), std::string::npos);
}

TEST(HttpServer, StopsWhilePagesListenAndAreSlow) {
  const auto begin = steady_clock::now();
  std::vector<Socket> sockets;
  {
    const Served served;
    sockets.emplace_back(served.port);
    sockets.back().send(served.text("GET /api/v1/events"));
    EXPECT_FALSE(sockets.back().receive(5000, "welcome").empty());
    sockets.emplace_back(served.port);
    sockets.back().send("GET / HT");
    sockets.emplace_back(served.port);
  }
  EXPECT_LT((steady_clock::now() - begin) / milliseconds(1), 5000);
}

TEST(HttpServer, RecognizesLoopbackAddresses) {
  for (const char* host : {"127.0.0.1", "127.8.9.10", "localhost", "::1"})
    EXPECT_TRUE(is_loopback(host)) << host;
  for (const char* host : {"0.0.0.0", "192.168.1.1", "::", "example.org", "127.evil.example", ""})
    EXPECT_FALSE(is_loopback(host)) << host;
}

TEST(HttpServer, RejectsAllAddressesHoweverTheyAreSpelled) {
  test::CaseApi own;
  for (const char* host : {"0.0.0.0", "0", "0x0", "00.0.0.0", "::", "::0", "::ffff:0.0.0.0"}) {
    HttpServer server(own.api, {.host = host, .port = 0, .token = kToken, .limits = {}});
    const auto port = server.bind();
    ASSERT_FALSE(port) << host;
    if (std::string(host).find(':') == std::string::npos) {  // IPv6 may be missing here.
      EXPECT_NE(port.error().message.find("wildcard"), std::string::npos) << port.error().message;
    }
  }
}

TEST(HttpServer, APortInUseIsReported) {
  const Served served;
  test::CaseApi other;
  HttpServer second(other.api,
                    {.host = "127.0.0.1", .port = served.port, .token = kToken, .limits = {}});
  const auto port = second.bind();
  ASSERT_FALSE(port);
  EXPECT_NE(port.error().message.find("in use"), std::string::npos);
}

}  // namespace
}  // namespace lefort::server::test_server_http
