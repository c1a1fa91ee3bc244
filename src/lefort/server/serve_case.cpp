#include <lefort/io/write_atomically.h>
#include <lefort/server/http/http_server.h>
#include <lefort/server/serve_case.h>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <optional>
#include <system_error>
#include <thread>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTokenDigits = 64;  // 256 bits.
constexpr rlim_t kDescriptors = 4096;     // For waiting connections and the case's files.
constexpr auto kStopPollInterval = std::chrono::milliseconds(100);
constexpr auto kMoment = std::chrono::milliseconds(1);

/// Raises the limit of open files, up to kDescriptors.
void allow_descriptors() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= kDescriptors) return;
  limit.rlim_cur = std::min(limit.rlim_max, kDescriptors);
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

/// Opens the page through a file that only this user can read: program arguments, which would show
/// the token, are visible to other users.
void open_browser(const std::string& address, const fs::path& file, Progress& progress) {
  const std::string page = fmt::format(
      "<!doctype html><meta charset=\"utf-8\"><title>lefort</title>"
      "<meta http-equiv=\"refresh\" content=\"0;url={}\">",
      address);
  const mode_t others = ::umask(0077);
  const Result<void> written = io::write_text(file, page);
  ::umask(others);
  std::string program = "xdg-open", argument = file.string();
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  if (!written ||
      ::posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0)
    progress.note("the browser could not be started (xdg-open): open the address yourself");
}

}  // namespace

Result<pipeline::Summary> serve_case(const ServeJob& job, Progress& progress) {
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
  const std::string address =
      fmt::format("http://{}:{}/#token={}", server::in_address(job.host), port, token);
  if (!is_own)
    progress.note(
        fmt::format("warning: {} is not a loopback address: others in the network can reach this "
                    "server, and the connection is not encrypted",
                    job.host));
  fmt::print("{}\n", address);
  std::fflush(stdout);
  const fs::path opener = api.folder() / "open.html";
  if (job.open) open_browser(address, opener, progress);

  std::atomic<bool> ended = false;
  std::thread listening([&] {
    http.run();
    ended = true;
  });
  while (!progress.stop_requested() && !ended) std::this_thread::sleep_for(kStopPollInterval);
  const bool is_requested = progress.stop_requested();
  while (!http.is_running() && !ended) std::this_thread::sleep_for(kMoment);
  http.stop();
  listening.join();
  fs::remove(opener, error);
  api.stop();
  if (!is_requested)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the server stopped listening at port {} of {}", port, job.host));
  pipeline::Summary summary;
  summary.text = "ended";
  summary.json = {{"ended", true}};
  return summary;
}

}  // namespace lefort::server
