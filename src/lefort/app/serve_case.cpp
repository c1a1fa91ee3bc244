#include <lefort/app/serve_case.h>
#include <lefort/app/server/http_server.h>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <system_error>
#include <thread>

namespace lefort::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTokenDigits = 64;  // 256 bits.
constexpr rlim_t kDescriptors = 4096;     // Connections that wait, and the case's files.
constexpr auto kLook = std::chrono::milliseconds(100);

/// As many as are allowed, up to what we want.
void allow_descriptors() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= kDescriptors) return;
  limit.rlim_cur = std::min(limit.rlim_max, kDescriptors);
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

void open_browser(const std::string& address, Progress& progress) {
  std::string program = "xdg-open", argument = address;
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0)
    progress.note("no browser could be opened (xdg-open): open the address yourself");
}

}  // namespace

Result<Summary> serve_case(const ServeJob& job, Progress& progress) {
  allow_descriptors();
  LEFORT_TRY(server::CaseFolder folder, server::CaseFolder::open(job.folder));
  std::error_code error;
  server::Api api(std::move(folder), fs::is_regular_file(job.example, error)
                                         ? std::optional(job.example)
                                         : std::nullopt);
  if (job.demo) LEFORT_TRY_VOID(api.begin_with_example());
  const std::string token = server::random_hex(kTokenDigits);
  server::HttpServer http(api, {.host = job.host, .port = job.port, .token = token, .limits = {}});
  LEFORT_TRY(const int port, http.bind());
  const bool is_own = server::is_loopback(job.host);
  const bool is_v6 = job.host.find(':') != std::string::npos;
  const std::string address =
      fmt::format("http://{}:{}/#token={}", is_v6 ? "[" + job.host + "]" : job.host, port, token);
  if (!is_own)
    progress.note(fmt::format(
        "warning: {} is not this machine's own address: others in the network can reach this "
        "server, and what is sent is not encrypted",
        job.host));
  fmt::print("{}\n", address);
  std::fflush(stdout);
  if (job.open) open_browser(address, progress);

  std::thread listening([&] { http.run(); });
  while (!progress.stop_requested()) std::this_thread::sleep_for(kLook);
  http.stop();
  listening.join();
  api.stop();
  Summary summary;
  summary.text = "ended";
  summary.json = {{"ended", true}};
  return summary;
}

}  // namespace lefort::app
