/// \file
/// A client's socket with timeouts for all bytes that are sent and received.
#pragma once

#include <lefort/server/http/http_server.h>

#include <httplib.h>
// A macro of <resolv.h>, which httplib.h brings; Eigen has parameters of that name.
#undef _res

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <string>

namespace lefort::server {

/// A stream with a timeout for each phase. Its owner closes the socket.
class Connection final : public httplib::Stream {
 public:
  using Clock = std::chrono::steady_clock;

  Connection(int socket, const HttpLimits& limits);

  /// Waits for the first byte of a request. \returns false at the timeout.
  [[nodiscard]] bool wait_for_request();

  /// Starts the phase that reads a body.
  void begin_body();

  /// Starts the phase of events: no total timeout, only a timeout for each piece.
  void begin_events() { phase_ = Phase::kEvents; }

  /// Whether the connection occupies a thread without a complete request header, or with a client
  /// that does not read the response.
  [[nodiscard]] bool is_waiting() const { return is_waiting_; }
  /// Time at which the wait began; for a response, one second later. \pre is_waiting().
  [[nodiscard]] Clock::time_point since() const { return since_.load(); }

  /// Ends the connection, from another thread. \pre the socket is open.
  void abort() const;

  /// Reads some of what the client still sends: otherwise the reply can be lost.
  void drain();

  /// Whether the rest of the stream is invalid: no further request is read from it.
  bool must_close = false;

  [[nodiscard]] bool is_readable() const override;
  [[nodiscard]] bool is_writable() const override;
  ssize_t read(char* to, size_t size) override;
  ssize_t write(const char* from, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  enum class Phase { kHeader, kBody, kReply, kEvents };
  /// Deadline of the next piece.
  [[nodiscard]] Clock::time_point deadline() const;
  [[nodiscard]] bool wait_for(short events, Clock::time_point until) const;
  /// Receives more bytes behind those of the buffer. \returns the result of recv(), or -1.
  ssize_t receive();
  void hide_range();

  const int socket_;
  const HttpLimits& limits_;
  Phase phase_ = Phase::kHeader;
  Clock::time_point begun_ = Clock::now();  ///< Start of the phase.
  double moved_ = 0.0;                      ///< Bytes transferred in the phase.
  std::atomic<bool> is_waiting_ = true;
  std::atomic<Clock::time_point> since_ = Clock::now();
  std::string buffer_;
  std::size_t at_ = 0;
  bool is_line_start_ = true;  ///< Of a header: the next byte is the first of a line.
};

}  // namespace lefort::server
