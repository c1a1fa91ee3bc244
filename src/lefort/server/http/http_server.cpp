#include <lefort/core/check.h>
#include <lefort/server/http/authorize_request.h>
#include <lefort/server/http/connection.h>
#include <lefort/server/http/http_server.h>
#include <lefort/server/http/page.h>
#include <lefort/server/http/workers.h>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <optional>
#include <utility>
#include <vector>

namespace lefort::server {
namespace {

constexpr std::size_t kPiece = 256 << 10;  // Bytes of a reply written at a time.
constexpr std::size_t kRequestsPerConnection = 1000;
constexpr auto kHeartbeat = std::chrono::seconds(15);  // As in the contract.
constexpr auto kListenerPollInterval =
    std::chrono::milliseconds(500);  // Interval in which listeners are checked.

constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' "
    "data: blob:; font-src 'self'; connect-src 'self'; worker-src 'self' blob:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

/// The connection served by the current thread.
thread_local Connection* current = nullptr;

/// httplib's server on connections with timeouts. httplib parses and formats.
class LimitedServer final : public httplib::Server {
 public:
  explicit LimitedServer(const HttpLimits& limits) : limits_(limits) {
    new_task_queue = [this] { return workers_ = new Workers(limits_); };
  }

  /// httplib has a backlog of five; other clients would wait for a second or more.
  void set_listen_backlog() { ::listen(svr_sock_, limits_.waiting); }

  /// Whether the bound address stands for all addresses of the machine, however it was spelled.
  [[nodiscard]] bool is_wildcard() const {
    sockaddr_storage bound{};
    socklen_t size = sizeof(bound);
    if (::getsockname(svr_sock_, reinterpret_cast<sockaddr*>(&bound), &size) != 0) return true;
    if (bound.ss_family == AF_INET)
      return reinterpret_cast<const sockaddr_in&>(bound).sin_addr.s_addr == htonl(INADDR_ANY);
    const in6_addr& v6 = reinterpret_cast<const sockaddr_in6&>(bound).sin6_addr;
    return IN6_IS_ADDR_UNSPECIFIED(&v6) ||
           (IN6_IS_ADDR_V4MAPPED(&v6) && v6.s6_addr32[3] == htonl(INADDR_ANY));
  }

  /// Closes the bound socket without listening.
  void close_socket() {
    ::close(svr_sock_);
    svr_sock_ = INVALID_SOCKET;
  }

  /// Called with each request after its header; may change it.
  std::function<void(httplib::Request&)> on_header;

 private:
  bool process_and_close_socket(socket_t socket) override {
    if (Workers::is_rejecting()) {
      constexpr std::string_view kBusy =
          "HTTP/1.1 503 Service Unavailable\r\nContent-Length: 0\r\nRetry-After: 1\r\n"
          "Connection: close\r\n\r\n";
      static_cast<void>(::send(socket, kBusy.data(), kBusy.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
      ::close(socket);
      return false;
    }
    Connection connection(socket, limits_);
    workers_->enter(&connection);
    current = &connection;
    bool is_served = false;
    for (std::size_t n = 1; n <= kRequestsPerConnection; ++n) {
      if (!connection.wait_for_request()) break;
      bool is_closed = false;
      try {
        is_served = process_request(connection, n == kRequestsPerConnection, is_closed, on_header);
      } catch (const std::exception&) {  // A reply may need more memory than there is.
        is_served = false;
      }
      if (!is_served || is_closed || connection.must_close) break;
    }
    current = nullptr;
    if (connection.must_close) connection.drain();
    workers_->leave(&connection);
    ::close(socket);
    return is_served;
  }

  const HttpLimits& limits_;
  Workers* workers_ = nullptr;  ///< httplib owns it while it listens.
};

/// A reply that was decided before the body was read.
thread_local std::optional<Response> decided;

Request as_request(const httplib::Request& from) {
  Request request;
  request.method = from.method == "HEAD" ? "GET" : from.method;
  request.path = from.path;
  for (const auto& [name, value] : from.params) request.query.emplace(name, value);
  for (const auto& [name, value] : from.headers) request.header.emplace(lower_case(name), value);
  return request;
}

}  // namespace

struct HttpServer::Parts {
  Parts(Api& api_of, HttpOptions options_of)
      : api(api_of),
        options(std::move(options_of)),
        server(options.limits),
        ours{.hosts = {}, .origins = {}, .token = options.token} {}

  Api& api;
  HttpOptions options;
  LimitedServer server;
  int port = 0;
  Credentials ours;
  std::atomic<int> listeners = 0;

  void pre_route(httplib::Request& request);
  void answer(const httplib::Request& request, httplib::Response& response, Response reply);
  void answer_events(httplib::Response& response, const std::string& last_id);
  void serve_body(const httplib::Request& request, httplib::Response& response,
                  const httplib::ContentReader& read);
  bool serve(const httplib::Request& request, httplib::Response& response);
};

bool is_loopback(const std::string& host) {
  if (host == "localhost") return true;
  in_addr v4{};
  if (::inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  in6_addr v6{};
  return ::inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

std::string in_address(const std::string& host) {
  return host.find(':') == std::string::npos ? host : fmt::format("[{}]", host);
}

/// Authorizes a request before its body is read, and disables features of httplib.
void HttpServer::Parts::pre_route(httplib::Request& request) {
  decided = authorize_request(request, ours);
  request.ranges.clear();
  request.headers.erase("Accept-Encoding");  // No compression on one machine.
  if (decided) {
    request.headers.erase("Expect");
    request.path.assign(1, '/');  // A rejected request matches no route.
    request.target = request.path;
    current->must_close = true;
    request.headers.erase("Connection");
    request.headers.emplace("Connection", "close");
  }
}

void HttpServer::Parts::answer_events(httplib::Response& response, const std::string& last_id) {
  if (++listeners > options.limits.listeners) {
    --listeners;
    answer({}, response, error_response(429, "limit", "too many pages receive events"));
    return;
  }
  EventLog& events = api.events();
  struct Listener {
    std::uint64_t heard = 0;
    std::string first;
    std::chrono::steady_clock::time_point reported = std::chrono::steady_clock::now();
  };
  const auto listener = std::make_shared<Listener>();
  const auto known = events.find(last_id);
  listener->heard = known.value_or(events.now());
  // So that a page knows at once that it is connected, and its position.
  listener->first = known || last_id.empty() ? ": welcome\n\n" : events.reset_event();
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, &events, listener](std::size_t, httplib::DataSink& sink) {
        current->begin_events();
        if (!listener->first.empty()) {
          const std::string first = std::exchange(listener->first, {});
          return sink.write(first.data(), first.size());
        }
        std::string text = events.wait(listener->heard, kListenerPollInterval);
        if (events.is_stopped()) {
          sink.done();
          return true;
        }
        const auto now = std::chrono::steady_clock::now();
        if (text.empty() && now - listener->reported > kHeartbeat) text = ": still here\n\n";
        if (text.empty()) return sink.is_writable();
        listener->reported = now;
        return sink.write(text.data(), text.size());
      },
      [this](bool) { --listeners; });
}

void HttpServer::Parts::answer(const httplib::Request& request, httplib::Response& response,
                               Response reply) {
  response.status = reply.status;
  for (const auto& [name, value] : reply.headers) response.set_header(name, value);
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Referrer-Policy", "no-referrer");
  response.set_header("Cross-Origin-Opener-Policy", "same-origin");
  response.set_header("Cross-Origin-Resource-Policy", "same-origin");
  response.set_header("Content-Security-Policy", kContentSecurityPolicy);
  response.set_header("X-Frame-Options", "DENY");
  response.set_header("Cache-Control", request.path.starts_with("/assets/") && reply.status == 200
                                           ? "private, max-age=31536000, immutable"
                                           : "no-store");
  if (reply.events_after) {
    answer_events(response, *reply.events_after);
  } else if (reply.file) {
    const auto file = std::make_shared<std::ifstream>(*reply.file, std::ios::binary);
    // Of the opened file: a job can replace it.
    const std::streamoff size = file->seekg(0, std::ios::end).tellg();
    if (size < 0) {
      response.status = 404;
      return;
    }
    if (size == 0) return;
    response.set_content_provider(
        std::size_t(size), reply.type.c_str(),
        [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
          std::string piece(std::min(length, kPiece), '\0');
          file->seekg(std::streamoff(offset));
          file->read(piece.data(), std::streamsize(piece.size()));
          return file->gcount() == std::streamsize(piece.size()) &&
                 sink.write(piece.data(), piece.size());
        });
  } else if (reply.bytes && !reply.bytes->bytes.empty()) {
    const SharedBytes bytes = *reply.bytes;
    response.set_content_provider(
        bytes.bytes.size(), reply.type.c_str(),
        [bytes](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
          return sink.write(bytes.bytes.data() + offset, std::min(length, kPiece));
        });
  } else if (reply.status != 204 && reply.status != 304) {
    response.set_content(reply.text, reply.type.c_str());
  }
}

/// Handles requests without a body, and rejected ones. \returns whether it was one.
bool HttpServer::Parts::serve(const httplib::Request& request, httplib::Response& response) {
  if (decided) {
    answer(request, response, *std::exchange(decided, std::nullopt));
    return true;
  }
  if (request.method == "POST" || request.method == "PUT") return false;
  current->begin_body();
  if (request.path.starts_with(kApiPrefix)) {
    answer(request, response, api.handle(as_request(request)));
    return true;
  }
  Response reply;
  if (request.method != "GET" && request.method != "HEAD") {
    reply =
        error_response(405, "not_allowed", "this method is not supported for this path", "method");
  } else if (const PageFile* const file = find_page_file(request.path)) {
    reply = binary_response({nullptr, file->bytes});
    reply.type = file->type;
  } else {
    reply = error_response(404, "not_found", "not found", "path");
  }
  answer(request, response, std::move(reply));
  return true;
}

void HttpServer::Parts::serve_body(const httplib::Request& request, httplib::Response& response,
                                   const httplib::ContentReader& read) {
  current->begin_body();
  Request requested = as_request(request);
  const std::string length = request.get_header_value("Content-Length");
  requested.content_length = length.empty() ? 0 : std::stoull(length);
  bool is_read = requested.content_length == 0;
  requested.read_body = [&](const BodyTaker& take) {
    if (is_read) return true;
    is_read = read([&](const char* bytes, std::size_t count) { return take({bytes, count}); });
    return is_read;
  };
  Response reply = api.handle(requested);
  if (!is_read) current->must_close = true;
  answer(request, response, std::move(reply));
}

HttpServer::HttpServer(Api& api, HttpOptions options)
    : parts_(std::make_unique<Parts>(api, std::move(options))) {
  LEFORT_CHECK(parts_->options.token.size() >= 32);
  Parts& parts = *parts_;
  parts.server.on_header = [&parts](httplib::Request& request) { parts.pre_route(request); };
  parts.server.set_payload_max_length(std::size_t(-1));  // The API has its own limits.
  parts.server.set_tcp_nodelay(true);
  // Connection limits are ours; httplib announces these to clients.
  parts.server.set_keep_alive_max_count(kRequestsPerConnection);
  parts.server.set_keep_alive_timeout(
      std::chrono::duration_cast<std::chrono::seconds>(parts.options.limits.idle_time).count());
  parts.server.set_pre_routing_handler([&parts](const auto& request, auto& response) {
    return parts.serve(request, response) ? httplib::Server::HandlerResponse::Handled
                                          : httplib::Server::HandlerResponse::Unhandled;
  });
  const auto with_body = [&parts](const httplib::Request& request, httplib::Response& response,
                                  const httplib::ContentReader& read) {
    parts.serve_body(request, response, read);
  };
  parts.server.Post(R"([\s\S]*)", with_body);
  parts.server.Put(R"([\s\S]*)", with_body);
  parts.server.set_exception_handler(
      [&parts](const auto& request, auto& response, const std::exception_ptr&) {
        current->must_close = true;
        parts.answer(request, response,
                     error_response(500, "internal",
                                    "an internal error; nothing was "
                                    "changed"));
      });
  parts.server.set_error_handler([&parts](const httplib::Request& request,
                                          httplib::Response& response) {
    if (!response.body.empty() || response.status == 304) return;
    current->must_close = true;
    parts.answer(request, response,
                 error_response(response.status, "bad_request", "the request cannot be parsed"));
  });
}

HttpServer::~HttpServer() { stop(); }

Result<int> HttpServer::bind() {
  Parts& parts = *parts_;
  const HttpOptions& options = parts.options;
  // Not SO_REUSEPORT, httplib's default: another program could receive half of the requests.
  parts.server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  parts.port = options.port;
  const bool is_bound = options.port == 0
                            ? (parts.port = parts.server.bind_to_any_port(options.host)) > 0
                            : parts.server.bind_to_port(options.host, options.port);
  if (!is_bound)
    return fail(ErrorCode::kInvalidArgument,
                options.port == 0 ? fmt::format("no port of {} is free", options.host)
                                  : fmt::format("port {} of {} cannot be bound; it may be in use",
                                                options.port, options.host));
  if (parts.server.is_wildcard()) {
    parts.server.close_socket();
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("--host {} is a wildcard address, by which requests cannot be checked: "
                            "use the address that browsers open",
                            options.host));
  }
  parts.server.set_listen_backlog();
  std::vector<std::string> names{"127.0.0.1", "localhost", "[::1]"};
  if (!is_loopback(options.host)) names.push_back(lower_case(in_address(options.host)));
  for (const std::string& name : names) {
    parts.ours.hosts.insert(fmt::format("{}:{}", name, parts.port));
    parts.ours.origins.insert(fmt::format("http://{}:{}", name, parts.port));
  }
  return parts.port;
}

void HttpServer::run() { parts_->server.listen_after_bind(); }

bool HttpServer::is_running() const { return parts_->server.is_running(); }

void HttpServer::stop() {
  parts_->api.events().stop();
  parts_->server.stop();
}

}  // namespace lefort::server
