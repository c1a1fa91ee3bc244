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

/// Blocks SIGPIPE in this thread while it lives, so that writing to a closed connection is an error
/// and does not end the program. A signal raised meanwhile is discarded.
class SigpipeGuard {
 public:
  SigpipeGuard() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &previous_);
  }
  ~SigpipeGuard() {
    const timespec no_wait{0, 0};
    while (::sigtimedwait(&pipe_, nullptr, &no_wait) == SIGPIPE) {
    }
    ::pthread_sigmask(SIG_SETMASK, &previous_, nullptr);
  }
  SigpipeGuard(const SigpipeGuard&) = delete;
  SigpipeGuard& operator=(const SigpipeGuard&) = delete;

 private:
  sigset_t pipe_{}, previous_{};
};

tl::unexpected<Error> status_error(int status) {
  if (status == 401 || status == 403)
    return fail(ErrorCode::kAccessDenied,
                fmt::format("the server rejects the user name or password (status {})", status));
  if (status == 404 || status == 204)
    return fail(ErrorCode::kFileNotFound,
                fmt::format("the server has no such study or series (status {})", status));
  return fail(ErrorCode::kFileUnsupported,
              fmt::format("the server answers with status {}, expected 200", status));
}

tl::unexpected<Error> connection_error(const HttpServer& server, CURLcode code, bool is_connected) {
  const std::string address = fmt::format("{}:{}", server.host, server.port);
  switch (code) {
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_SSL_CERTPROBLEM:
    case CURLE_SSL_CIPHER:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_SSL_ISSUER_ERROR:
    case CURLE_PEER_FAILED_VERIFICATION:
      return fail(
          ErrorCode::kConnectionFailed,
          fmt::format("the server at {} has no trusted certificate or does not encrypt", address));
    default:
      if (!is_connected)
        return fail(ErrorCode::kConnectionFailed, fmt::format("no server answers at {}", address));
      return fail(ErrorCode::kConnectionFailed,
                  fmt::format("the connection to the server at {} was lost", address));
  }
}

/// The options of one libcurl request. After the first option that libcurl rejects, no other is set
/// and result() is an error, so that no request is sent without one of its restrictions.
class RequestOptions {
 public:
  explicit RequestOptions(CURL* curl) : curl_(curl) {}

  /// \param value  of the type that libcurl documents for `option`: long, pointer or function.
  template <class T>
  void set(CURLoption option, T value) {
    if (code_ != CURLE_OK) return;
    code_ = ::curl_easy_setopt(curl_, option, value);
    option_ = option;
  }

  [[nodiscard]] Result<void> result() const {
    if (code_ == CURLE_OK) return {};
    if (code_ == CURLE_OUT_OF_MEMORY) throw std::bad_alloc();
    return fail(ErrorCode::kConnectionFailed,
                fmt::format("libcurl rejects option {} of the request: {}",
                            static_cast<int>(option_), ::curl_easy_strerror(code_)));
  }

 private:
  CURL* curl_;
  CURLcode code_ = CURLE_OK;
  CURLoption option_ = CURLOPT_LASTENTRY;
};

/// Receives the response. libcurl calls it in the thread of the request.
class ResponseReceiver {
 public:
  ResponseReceiver(CURL* curl, const HttpRequest& request, Progress& progress)
      : curl_(curl),
        request_(request),
        progress_(progress),
        deadline_(Clock::now() + request.total_timeout) {}

  /// Registers the callbacks. The object must outlive the request.
  void add_to(RequestOptions& options) {
    using BytesCallback = std::size_t (*)(char*, std::size_t, std::size_t, void*);
    using ProgressCallback = int (*)(void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t);
    void* const self = this;
    options.set(CURLOPT_HEADERDATA, self);
    options.set<BytesCallback>(CURLOPT_HEADERFUNCTION,
                               [](char* bytes, std::size_t, std::size_t count, void* receiver) {
                                 return static_cast<ResponseReceiver*>(receiver)->receive(
                                     &ResponseReceiver::on_header_line, bytes, count);
                               });
    options.set(CURLOPT_WRITEDATA, self);
    options.set<BytesCallback>(CURLOPT_WRITEFUNCTION,
                               [](char* bytes, std::size_t, std::size_t count, void* receiver) {
                                 return static_cast<ResponseReceiver*>(receiver)->receive(
                                     &ResponseReceiver::on_body, bytes, count);
                               });
    options.set(CURLOPT_NOPROGRESS, 0L);
    options.set(CURLOPT_XFERINFODATA, self);
    options.set<ProgressCallback>(CURLOPT_XFERINFOFUNCTION, [](void* receiver, curl_off_t,
                                                               curl_off_t, curl_off_t, curl_off_t) {
      return static_cast<ResponseReceiver*>(receiver)->should_continue() ? 0 : 1;
    });
  }

  /// The error for which this object ended the transfer, if it did.
  [[nodiscard]] const std::optional<Error>& abort_reason() const { return abort_reason_; }

  /// Throws the exception that a callback of the request threw, if one did.
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

  [[nodiscard]] int status() const {
    long status = 0;
    ::curl_easy_getinfo(curl_, CURLINFO_RESPONSE_CODE, &status);
    return static_cast<int>(status);
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Handler = Result<void> (ResponseReceiver::*)(std::string_view);

  /// \returns `count`, or 0 to end the transfer. No exception may pass through libcurl.
  std::size_t receive(Handler handler, const char* bytes, std::size_t count) {
    try {
      if (!abort_reason_)
        if (Result<void> handled = (this->*handler)({bytes, count}); !handled)
          abort_reason_ = std::move(handled).error();
    } catch (...) {
      thrown_ = std::current_exception();
    }
    return !thrown_ && should_continue() ? count : 0;
  }

  Result<void> on_header_line(std::string_view line) {
    header_bytes_ += line.size();
    if (header_bytes_ > request_.header_bytes)
      return fail(
          ErrorCode::kFileCorrupt,
          fmt::format("the server's headers have more than {} bytes", request_.header_bytes));
    const bool is_last = line == "\r\n" || line == "\n";
    if (!is_last || has_begun_ || status() != 200) return {};
    has_begun_ = true;  // Header lines after the body (trailers) are ignored.
    const char* type = nullptr;
    ::curl_easy_getinfo(curl_, CURLINFO_CONTENT_TYPE, &type);
    return request_.begin(type == nullptr ? "" : type);
  }

  Result<void> on_body(std::string_view bytes) {
    if (status() != 200) return status_error(status());
    return request_.receive(bytes);
  }

  bool should_continue() {
    if (progress_.stop_requested())
      abort_reason_ = Error{ErrorCode::kCancelled, "the transfer of the scan was stopped"};
    else if (!abort_reason_ && Clock::now() > deadline_)
      abort_reason_ =
          Error{ErrorCode::kConnectionFailed,
                fmt::format("the server takes longer than {} s", request_.total_timeout.count())};
    return !abort_reason_;
  }

  CURL* curl_;
  const HttpRequest& request_;
  Progress& progress_;
  Clock::time_point deadline_;
  std::uint64_t header_bytes_ = 0;
  bool has_begun_ = false;
  std::optional<Error> abort_reason_;
  std::exception_ptr thrown_;
};

/// Sets address, restrictions, timeouts and credentials.
void set_request(RequestOptions& options, const HttpServer& server, const HttpRequest& request,
                 curl_slist* headers) {
  const std::string url = fmt::format("{}://{}:{}{}", server.is_encrypted ? "https" : "http",
                                      server.host, server.port, request.path);
  options.set(CURLOPT_URL, url.c_str());  // libcurl copies strings.
  options.set(CURLOPT_HTTPHEADER, headers);
  options.set(CURLOPT_PROTOCOLS_STR, "http,https");
  options.set(CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_1_1});
  options.set(CURLOPT_PATH_AS_IS, 1L);
  options.set(CURLOPT_PROXY, "");  // No proxy may see passwords and scans.
  options.set(CURLOPT_NOSIGNAL, 1L);
  const long idle_timeout = static_cast<long>(request.idle_timeout.count());
  options.set(CURLOPT_CONNECTTIMEOUT, idle_timeout);
  options.set(CURLOPT_LOW_SPEED_LIMIT, 1L);  // Bytes per second.
  options.set(CURLOPT_LOW_SPEED_TIME, idle_timeout);
  if (server.user.empty() && server.password.empty()) return;
  options.set(CURLOPT_HTTPAUTH, static_cast<long>(CURLAUTH_BASIC));
  options.set(CURLOPT_USERNAME, server.user.c_str());
  options.set(CURLOPT_PASSWORD, server.password.c_str());
}

}  // namespace

Result<void> http_get(const HttpServer& server, const HttpRequest& request, Progress& progress) {
  const SigpipeGuard no_sigpipe;
  const std::unique_ptr<CURL, void (*)(CURL*)> transfer(::curl_easy_init(), ::curl_easy_cleanup);
  const std::unique_ptr<curl_slist, void (*)(curl_slist*)> headers(
      ::curl_slist_append(nullptr, ("Accept: " + request.accept).c_str()), ::curl_slist_free_all);
  if (transfer == nullptr || headers == nullptr) throw std::bad_alloc();
  CURL* const curl = transfer.get();
  RequestOptions options(curl);
  ResponseReceiver receiver(curl, request, progress);
  set_request(options, server, request, headers.get());
  receiver.add_to(options);
  LEFORT_TRY_VOID(options.result());

  const CURLcode code = ::curl_easy_perform(curl);
  receiver.rethrow();
  if (receiver.abort_reason()) return tl::unexpected(*receiver.abort_reason());
  curl_off_t connected_us = 0;
  ::curl_easy_getinfo(curl, CURLINFO_CONNECT_TIME_T, &connected_us);
  if (code != CURLE_OK) return connection_error(server, code, connected_us > 0);
  if (receiver.status() != 200) return status_error(receiver.status());
  return {};
}

}  // namespace lefort::io
