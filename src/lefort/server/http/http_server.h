/// \file
/// The API and the page over HTTP/1.1 on this machine, for one user, against all others.
///
/// Refused before a body is read: a Host that is not ours (DNS rebinding), a foreign Origin, a
/// wrong or missing token, a body without or beyond its length, any transfer coding. Connections,
/// threads, header bytes and time are bounded; who is slow makes room for who is not.
#pragma once

#include <lefort/core/error.h>
#include <lefort/server/api/api.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace lefort::server {

/// How much a client may ask for.
struct HttpLimits {
  int threads = 48;    ///< Requests at a time, listeners of events among them.
  int listeners = 16;  ///< Of events.
  int waiting = 1024;  ///< Connections that wait for a thread; further ones are sent away.
  std::size_t header_bytes = 32 << 10;          ///< Request line and headers.
  std::chrono::milliseconds header_time{5000};  ///< For them to arrive.
  std::chrono::milliseconds idle_time{15000};   ///< Between two requests.
  /// How long a connection without a whole header may keep a thread that another one waits for.
  std::chrono::milliseconds eviction_timeout{100};
  std::chrono::milliseconds stall_time{10000};  ///< In which a body or a reply must move on.
  double min_throughput_bytes_per_s = 65536;    ///< Of a body or a reply, in the mean.
};

struct HttpOptions {
  std::string host = "127.0.0.1";  ///< The address to listen at.
  int port = 0;                    ///< 0: any that is free.
  std::string token;               ///< What every request about the case must show.
  HttpLimits limits;
};

/// Whether an address is this machine's own alone.
[[nodiscard]] bool is_loopback(const std::string& host);

/// An address as it stands in a URL: that of IPv6 in brackets.
[[nodiscard]] std::string in_address(const std::string& host);

class HttpServer {
 public:
  /// \param api  outlives the server.
  HttpServer(Api& api, HttpOptions options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Takes the port.
  ///
  /// \returns the port, or kInvalidArgument: it is in use, the address is not this machine's, or it
  ///   stands for all addresses.
  [[nodiscard]] Result<int> bind();

  /// Serves until stop(). \pre bind() succeeded.
  void run();

  /// Whether run() listens already: a stop() before it does has no effect.
  [[nodiscard]] bool is_running() const;

  /// From any thread; not from a signal handler.
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lefort::server
