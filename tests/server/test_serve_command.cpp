/// \file
/// `lefort serve` as a program: how it begins, ends, and is killed.
#include <lefort/io/read_text.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/server/serve_case.h>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include "support/run_program.h"
#include "support/serve_here.h"
#include "support/small_head.h"

namespace lefort::server::test_serve_command {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The program at work.
class Program {
 public:
  explicit Program(const fs::path& folder) {
    int out[2];
    if (::pipe(out) != 0) return;
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(out[1], STDOUT_FILENO);
      const int nothing = ::open("/dev/null", O_WRONLY);
      ::dup2(nothing, STDERR_FILENO);
      const std::string at = folder.string();
      ::execl(LEFORT_PROGRAM, LEFORT_PROGRAM, "serve", at.c_str(), "--port", "0", "--threads", "2",
              nullptr);
      ::_exit(127);
    }
    ::close(out[1]);
    std::string line;
    for (char c = 0; ::read(out[0], &c, 1) == 1 && c != '\n';) line += c;
    ::close(out[0]);
    const std::size_t colon = line.find(':', 6), slash = line.find("/#token=");
    if (slash == std::string::npos) return;
    port = std::stoi(line.substr(colon + 1, slash - colon - 1));
    token = line.substr(slash + 8);
  }
  ~Program() { end(SIGKILL); }

  /// \returns the exit code, or minus the signal.
  int end(int signal) {
    if (pid_ <= 0) return 0;
    ::kill(pid_, signal);
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  /// The body of a reply.
  [[nodiscard]] std::string call_api(const std::string& line, const std::string& body = "") const {
    const test::Socket socket(port);
    socket.send(line + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                "\r\nConnection: close\r\nX-Lefort-Token: " + token +
                "\r\nContent-Type: application/json\r\nIf-Match: *\r\n" +
                (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") +
                "\r\n" + body);
    const std::string reply = socket.receive();
    const std::size_t at = reply.find("\r\n\r\n");
    return at == std::string::npos ? "" : reply.substr(at + 4);
  }
  [[nodiscard]] json get(const std::string& path) const {
    return json::parse(call_api("GET /api/v1" + path), nullptr, false);
  }
  [[nodiscard]] json run(const std::string& request) const {
    const int id = json::parse(call_api("POST /api/v1/jobs", request))["id"];
    while (true) {
      const json job = get("/jobs/" + std::to_string(id));
      if (job["state"] != "queued" && job["state"] != "running") return job;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  int port = 0;
  std::string token;

 private:
  pid_t pid_ = -1;
};

TEST(ServeCommand, EndsCleanlyAndHasAnotherTokenEachTime) {
  const test::TemporaryFolder folder;
  std::string token;
  for (const int signal : {SIGINT, SIGTERM}) {
    Program program(folder / "case");
    ASSERT_GT(program.port, 0);
    EXPECT_EQ(program.token.size(), 64U);
    EXPECT_NE(program.token, token);
    token = program.token;
    EXPECT_EQ(program.get("/case")["lefort_case"], 1);
    EXPECT_EQ(program.end(signal), 0);
  }
}

TEST(ServeCommand, EndsIfInterruptedBeforeItListens) {
  class Interrupted final : public Progress {
   public:
    [[nodiscard]] bool stop_requested() const override { return true; }
  };
  for (int n = 0; n < 20; ++n) {
    const test::TemporaryFolder folder;
    Interrupted progress;
    ServeJob job;
    job.folder = folder / "case";
    job.port = 0;
    EXPECT_TRUE(serve_case(job, progress));
  }
}

TEST(ServeCommand, ASecondServerOnACaseIsRejectedWithOneLine) {
  const test::TemporaryFolder folder;
  const Program first(folder / "case");
  ASSERT_GT(first.port, 0);
  const auto second = test::run_lefort("serve '" + (folder / "case").string() + "' --port 0");
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_EQ(second.message_lines(), 1) << second.error;
  EXPECT_NE(second.error.find("in use by another lefort serve"), std::string::npos);
  const auto port = test::run_lefort("serve '" + (folder / "other").string() + "' --port " +
                                     std::to_string(first.port));
  EXPECT_EQ(port.exit_code, 1);
  EXPECT_EQ(port.message_lines(), 1) << port.error;
}

TEST(ServeCommand, AKilledPredictionResumesWithTheSameBytes) {
  const test::TemporaryFolder folder;
  const fs::path root = folder / "case";
  fs::create_directories(root);
  ASSERT_TRUE(io::write_volume(root / "ct.nrrd", test::small_head()));
  json plan = test::small_plan();
  plan["segments"][0]["path"]["steps"] = 6;
  ASSERT_TRUE(io::write_text(root / "plan.json", plan.dump()));
  const auto whole = test::run_lefort("predict '" + (root / "plan.json").string() + "' --ct '" +
                                      (root / "ct.nrrd").string() + "' --no-pictures -o '" +
                                      (folder / "whole").string() + "'");
  ASSERT_EQ(whole.exit_code, 0) << whole.error;
  int id = 0;
  {
    Program program(root);
    ASSERT_GT(program.port, 0);
    id = json::parse(program.call_api("POST /api/v1/jobs", R"({"kind":"predict"})"))["id"];
    while (true) {  // Until the second step is found: the first is kept then.
      const json job = program.get("/jobs/" + std::to_string(id));
      int steps = 0;
      for (const json& line : job["lines"])
        steps += line.get<std::string>().find("% of the path") != std::string::npos;
      if (steps >= 2) break;
      ASSERT_TRUE(job["state"] == "queued" || job["state"] == "running") << job;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_EQ(program.end(SIGKILL), -SIGKILL);
  }
  const Program again(root);
  ASSERT_GT(again.port, 0);
  EXPECT_EQ(again.get("/jobs/" + std::to_string(id))["state"], "interrupted");
  EXPECT_NE(again.get("/case")["stages"]["prediction"]["why"].get<std::string>().find("resumes"),
            std::string::npos);
  const json job = again.run(R"({"kind":"predict"})");
  ASSERT_EQ(job["state"], "done") << job;
  EXPECT_NE(job["lines"].dump().find("were computed by an earlier run"), std::string::npos);
  for (const char* file : {"predicted_skin.vtp", "predicted_skin.stl", "paraview/step_0006.vtu"})
    EXPECT_EQ(io::read_text(root / "prediction" / file, 1 << 28).value(),
              io::read_text(folder / "whole" / file, 1 << 28).value())
        << file;
}

}  // namespace
}  // namespace lefort::server::test_serve_command
