/// \file
/// HTTP/1.1 server of the API and the page, for one user on this machine.
///
/// A request is rejected before its body is read if it has a Host other than this server (DNS
/// rebinding), a foreign Origin, a wrong or missing token (API only), a body whose length is not
/// stated or too large, or a transfer coding.
/// Connections, threads, header bytes and time are limited; slow connections are evicted when
/// others wait.
#pragma once

#include <lefort/core/error.h>
#include <lefort/server/api/api.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace lefort::server {

/// Limits of clients.
struct HttpLimits {
  int threads = 48;    ///< Concurrent requests, including listeners of events.
  int listeners = 16;  ///< Concurrent event streams.
  int waiting = 1024;  ///< Connections that wait for a thread; others are rejected.
  std::size_t header_bytes = 32 << 10;          ///< Request line and headers.
  std::chrono::milliseconds header_time{5000};  ///< To receive the header.
  std::chrono::milliseconds idle_time{15000};   ///< Between two requests.
  /// Time without a complete header after which a connection is evicted if another one waits.
  std::chrono::milliseconds eviction_timeout{100};
  std::chrono::milliseconds stall_time{10000};  ///< Without any byte of a body or a reply.
  double min_throughput_bytes_per_s = 65536;    ///< Mean, of a body or a reply.
};

struct HttpOptions {
  std::string host = "127.0.0.1";  ///< The address to listen at.
  int port = 0;                    ///< 0: any free port.
  std::string token;               ///< Required by the API; at least 32 characters.
  HttpLimits limits;
};

/// Whether an address is a loopback address.
[[nodiscard]] bool is_loopback(const std::string& host);

/// An address as it is written in a URL: IPv6 in brackets.
[[nodiscard]] std::string in_address(const std::string& host);

class HttpServer {
 public:
  /// \param api  must outlive the server.
  HttpServer(Api& api, HttpOptions options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Binds the port.
  ///
  /// \returns the port; or kInvalidArgument if the port is in use, or the address is a wildcard or
  ///   not an address of this machine.
  [[nodiscard]] Result<int> bind();

  /// Serves until stop(). \pre bind() succeeded.
  void run();

  /// Whether run() is listening. A stop() before that does not prevent run() from serving, but ends
  /// all event streams.
  [[nodiscard]] bool is_running() const;

  /// Can be called from any thread, but not from a signal handler.
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lefort::server
