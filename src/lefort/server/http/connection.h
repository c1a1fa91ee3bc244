/// \file
/// One client's socket with its patience: how long it may take for what it sends and takes.
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

/// A stream whose every phase has an end. Its owner closes the socket.
class Connection final : public httplib::Stream {
 public:
  using Clock = std::chrono::steady_clock;

  Connection(int socket, const HttpLimits& limits);

  /// Waits for the first byte of a request. \returns false if none came in time.
  [[nodiscard]] bool wait_for_request();

  /// From here on what is read is a body.
  void begin_body();

  /// From here on time is not limited while each piece moves on: events.
  void begin_events() { phase_ = Phase::kEvents; }

  /// Whether it holds a thread without having asked for anything, and since when.
  [[nodiscard]] bool is_waiting() const { return is_waiting_; }
  [[nodiscard]] Clock::time_point since() const { return since_.load(); }

  /// From another thread: ends it. \pre the socket is open.
  void abort() const;

  /// The client may still send what nobody reads: unless some of it is taken the reply is lost.
  void drain();

  /// What is left in the stream does not belong to a request: no other one may be read from it.
  bool must_close = false;

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* to, size_t size) override;
  ssize_t write(const char* from, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  enum class Phase { kHeader, kBody, kReply, kEvents };
  /// The moment up to which the next piece must have moved.
  [[nodiscard]] Clock::time_point deadline() const;
  [[nodiscard]] bool wait_for(short events, Clock::time_point until) const;

  const int socket_;
  const HttpLimits& limits_;
  Phase phase_ = Phase::kHeader;
  Clock::time_point begun_ = Clock::now();  ///< The phase.
  double moved_ = 0.0;                      ///< Bytes in the phase.
  std::atomic<bool> is_waiting_ = true;
  std::atomic<Clock::time_point> since_ = Clock::now();
  std::string buffer_;
  std::size_t at_ = 0;
};

}  // namespace lefort::server
