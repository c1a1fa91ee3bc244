#include <lefort/io/internal/http_get.h>

#include <curl/curl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>
#include <time.h>

#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <utility>

namespace lefort::io {

namespace {

/// While it lives, writing to a connection that was closed is an error, and not the end of the
/// program: SIGPIPE waits, and is taken back.
class SigpipeGuard {
 public:
  SigpipeGuard() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~SigpipeGuard() {
    const timespec at_once{0, 0};
    while (::sigtimedwait(&pipe_, nullptr, &at_once) == SIGPIPE) {
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  SigpipeGuard(const SigpipeGuard&) = delete;
  SigpipeGuard& operator=(const SigpipeGuard&) = delete;

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

tl::unexpected<Error> lost(const HttpServer& server, CURLcode why, bool is_connected) {
  const std::string place = fmt::format("{}:{}", server.host, server.port);
  switch (why) {
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_SSL_CERTPROBLEM:
    case CURLE_SSL_CIPHER:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_SSL_ISSUER_ERROR:
    case CURLE_PEER_FAILED_VERIFICATION:
      return fail(ErrorCode::kFileUnsupported,
                  fmt::format("the server at {} cannot be trusted, or does not encrypt", place));
    default:
      if (!is_connected)
        return fail(ErrorCode::kFileNotFound, fmt::format("no server answers at {}", place));
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the connection to the server at {} was lost", place));
  }
}

/// What libcurl calls while it waits and reads. All of it runs in the thread that asked.
class Listener {
 public:
  Listener(const HttpRequest& request, Progress& progress)
      : request_(request), progress_(progress), deadline_(Clock::now() + request.total_timeout) {}

  void listen_to(CURL* transfer) {
    transfer_ = transfer;
    ::curl_easy_setopt(transfer, CURLOPT_HEADERDATA, this);
    ::curl_easy_setopt(
        transfer, CURLOPT_HEADERFUNCTION,
        +[](char* bytes, std::size_t, std::size_t count, void* self) {
          return static_cast<Listener*>(self)->on_header_line(&Listener::header, bytes, count);
        });
    ::curl_easy_setopt(transfer, CURLOPT_WRITEDATA, this);
    ::curl_easy_setopt(
        transfer, CURLOPT_WRITEFUNCTION,
        +[](char* bytes, std::size_t, std::size_t count, void* self) {
          return static_cast<Listener*>(self)->on_header_line(&Listener::body, bytes, count);
        });
    ::curl_easy_setopt(transfer, CURLOPT_NOPROGRESS, 0L);
    ::curl_easy_setopt(transfer, CURLOPT_XFERINFODATA, this);
    ::curl_easy_setopt(
        transfer, CURLOPT_XFERINFOFUNCTION,
        +[](void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
          return static_cast<Listener*>(self)->should_continue() ? 0 : 1;
        });
  }

  /// Why we stopped listening, if it was us.
  [[nodiscard]] const std::optional<Error>& stopped() const { return stopped_; }

  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

  [[nodiscard]] int status() const {
    long status = 0;
    ::curl_easy_getinfo(transfer_, CURLINFO_RESPONSE_CODE, &status);
    return static_cast<int>(status);
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Part = Result<void> (Listener::*)(std::string_view);

  /// \returns `count`, or 0 to stop. No exception may pass through libcurl.
  std::size_t on_header_line(Part part, const char* bytes, std::size_t count) {
    try {
      if (!stopped_)
        if (Result<void> heard = (this->*part)({bytes, count}); !heard)
          stopped_ = std::move(heard).error();
    } catch (...) {
      thrown_ = std::current_exception();
    }
    return !thrown_ && should_continue() ? count : 0;
  }

  Result<void> header(std::string_view line) {
    header_bytes_ += line.size();
    if (header_bytes_ > request_.header_bytes)
      return fail(
          ErrorCode::kFileCorrupt,
          fmt::format("the server's headers have more than {} bytes", request_.header_bytes));
    const bool is_last = line == "\r\n" || line == "\n";
    if (!is_last || has_begun_ || status() != 200) return {};
    has_begun_ = true;  // What looks like headers after the body is none of theirs.
    const char* type = nullptr;
    ::curl_easy_getinfo(transfer_, CURLINFO_CONTENT_TYPE, &type);
    return request_.begin(type == nullptr ? "" : type);
  }

  Result<void> body(std::string_view bytes) {
    if (status() != 200) return refused(status());
    return request_.receive(bytes);
  }

  bool should_continue() {
    if (progress_.stop_requested())
      stopped_ = Error{ErrorCode::kCancelled, "fetching the scan was stopped"};
    else if (!stopped_ && Clock::now() > deadline_)
      stopped_ = Error{ErrorCode::kFileCorrupt, fmt::format("the server takes longer than {} s",
                                                            request_.total_timeout.count())};
    return !stopped_;
  }

  const HttpRequest& request_;
  Progress& progress_;
  Clock::time_point deadline_;
  CURL* transfer_ = nullptr;
  std::uint64_t header_bytes_ = 0;
  bool has_begun_ = false;
  std::optional<Error> stopped_;
  std::exception_ptr thrown_;
};

}  // namespace

Result<void> http_get(const HttpServer& server, const HttpRequest& request, Progress& progress) {
  const SigpipeGuard no_broken_pipe;
  const std::unique_ptr<CURL, void (*)(CURL*)> transfer(::curl_easy_init(), ::curl_easy_cleanup);
  const std::unique_ptr<curl_slist, void (*)(curl_slist*)> headers(
      ::curl_slist_append(nullptr, ("Accept: " + request.accept).c_str()), ::curl_slist_free_all);
  if (transfer == nullptr || headers == nullptr) throw std::bad_alloc();
  CURL* const curl = transfer.get();
  ::curl_easy_setopt(curl, CURLOPT_URL,
                     fmt::format("{}://{}:{}{}", server.is_encrypted ? "https" : "http",
                                 server.host, server.port, request.path)
                         .c_str());
  ::curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers.get());
  ::curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  ::curl_easy_setopt(curl, CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_1_1});
  ::curl_easy_setopt(curl, CURLOPT_PATH_AS_IS, 1L);
  ::curl_easy_setopt(curl, CURLOPT_PROXY, "");  // Passwords and scans go to the server alone.
  ::curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  const long idle_timeout = static_cast<long>(request.idle_timeout.count());
  ::curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, idle_timeout);
  ::curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);  // Bytes a second.
  ::curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, idle_timeout);
  if (!server.user.empty() || !server.password.empty()) {
    ::curl_easy_setopt(curl, CURLOPT_HTTPAUTH, CURLAUTH_BASIC);
    ::curl_easy_setopt(curl, CURLOPT_USERNAME, server.user.c_str());
    ::curl_easy_setopt(curl, CURLOPT_PASSWORD, server.password.c_str());
  }
  Listener listener(request, progress);
  listener.listen_to(curl);

  const CURLcode answer = ::curl_easy_perform(curl);
  listener.rethrow();
  if (listener.stopped()) return tl::unexpected(*listener.stopped());
  curl_off_t connected_us = 0;
  ::curl_easy_getinfo(curl, CURLINFO_CONNECT_TIME_T, &connected_us);
  if (answer != CURLE_OK) return lost(server, answer, connected_us > 0);
  if (listener.status() != 200) return refused(listener.status());
  return {};
}

}  // namespace lefort::io
