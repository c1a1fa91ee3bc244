#include <lefort/io/internal/http_get.h>

#include <fmt/format.h>
#include <httplib.h>
#include <pthread.h>
#include <signal.h>
#include <time.h>

#include <optional>

namespace lefort::io {

namespace {

/// While it lives, writing to a connection that was closed is an error, and not the end of the
/// program: SIGPIPE waits, and is taken back.
class NoBrokenPipe {
 public:
  NoBrokenPipe() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoBrokenPipe() {
    const timespec at_once{0, 0};
    while (::sigtimedwait(&pipe_, nullptr, &at_once) == SIGPIPE) {
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoBrokenPipe(const NoBrokenPipe&) = delete;
  NoBrokenPipe& operator=(const NoBrokenPipe&) = delete;

 private:
  sigset_t pipe_{}, before_{};
};

tl::unexpected<Error> refused(int status) {
  if (status == 401 || status == 403)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the server refuses user or password (status {})", status));
  if (status == 404 || status == 204)
    return fail(ErrorCode::kFileNotFound,
                fmt::format("the server has no such study or series (status {})", status));
  return fail(ErrorCode::kFileUnsupported,
              fmt::format("the server answers with status {}, expected 200", status));
}

tl::unexpected<Error> lost(const HttpServer& server, httplib::Error error) {
  const std::string place = fmt::format("{}:{}", server.host, server.port);
  switch (error) {
    case httplib::Error::Connection:
    case httplib::Error::ConnectionTimeout:
      return fail(ErrorCode::kFileNotFound, fmt::format("no server answers at {}", place));
    case httplib::Error::SSLConnection:
    case httplib::Error::SSLLoadingCerts:
    case httplib::Error::SSLServerVerification:
      return fail(ErrorCode::kFileUnsupported,
                  fmt::format("the server at {} cannot be trusted, or does not encrypt", place));
    default:
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the connection to the server at {} was lost", place));
  }
}

}  // namespace

Result<void> http_get(const HttpServer& server, const HttpRequest& request, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const NoBrokenPipe no_broken_pipe;
  httplib::Client client(
      fmt::format("{}://{}:{}", server.is_encrypted ? "https" : "http", server.host, server.port));
  if (!client.is_valid())
    return fail(ErrorCode::kFileNotFound,
                fmt::format("no server answers at {}:{}", server.host, server.port));
  client.set_connection_timeout(request.silence);
  client.set_read_timeout(request.silence);
  client.set_write_timeout(request.silence);
  if (!server.user.empty() || !server.password.empty())
    client.set_basic_auth(server.user, server.password);

  const auto deadline = Clock::now() + request.whole;
  std::optional<Error> stopped;  // Why we stopped listening.
  const auto goes_on = [&](Result<void> result) {
    if (!result) stopped = std::move(result).error();
    if (progress.stop_requested())
      stopped = Error{ErrorCode::kCancelled, "fetching the scan was stopped"};
    else if (!stopped && Clock::now() > deadline)
      stopped = Error{ErrorCode::kFileCorrupt,
                      fmt::format("the server takes longer than {} s", request.whole.count())};
    return !stopped;
  };
  int status = 0;
  const auto answer = client.Get(
      request.path, httplib::Headers{{"Accept", request.accept}},
      [&](const httplib::Response& response) {
        status = response.status;
        return status == 200 && goes_on(request.begin(response.get_header_value("Content-Type")));
      },
      [&](const char* bytes, std::size_t count) {
        return goes_on(request.receive(std::string_view(bytes, count)));
      });
  if (stopped) return tl::unexpected(*std::move(stopped));
  if (status != 0 && status != 200) return refused(status);
  if (!answer) return lost(server, answer.error());
  return {};
}

}  // namespace lefort::io
