/// \file
/// The planner's server on a port of this machine, and client sockets.
#pragma once

#include <lefort/server/http/http_server.h>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include "support/call_api.h"

namespace lefort::test {

inline const std::string kToken(64, '7');

/// A client's socket.
class Socket {
 public:
  explicit Socket(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(std::uint16_t(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_open_ =
        ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~Socket() { close(); }
  Socket(Socket&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), is_open_(other.is_open_) {}
  Socket& operator=(Socket&&) = delete;

  [[nodiscard]] bool is_open() const { return is_open_; }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  bool send(const std::string& bytes) const {
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t sent = ::send(socket_, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (sent <= 0) return false;
      at += std::size_t(sent);
    }
    return true;
  }
  /// Returns the bytes received until the server closes, `end` is received, or the time limit is
  /// reached.
  std::string receive(int longest_ms = 20000, const std::string& end = "") const {
    std::string text;
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(longest_ms);
    while (std::chrono::steady_clock::now() < until) {
      pollfd waiting{socket_, POLLIN, 0};
      if (::poll(&waiting, 1, 50) <= 0) continue;
      char piece[65536];
      const ssize_t count = ::recv(socket_, piece, sizeof(piece), 0);
      if (count <= 0) break;
      text.append(piece, std::size_t(count));
      if (!end.empty() && text.find(end) != std::string::npos) break;
    }
    return text;
  }

 private:
  int socket_;
  bool is_open_ = false;
};

/// An API with a server.
class Served {
 public:
  explicit Served(server::HttpLimits limits = {}, server::UploadLimits uploads = {})
      : own(uploads),
        http(own.api, {.host = "127.0.0.1", .port = 0, .token = kToken, .limits = limits}) {
    port = http.bind().value();
    thread_ = std::thread([this] { http.run(); });
    while (status("GET /api/v1/case") == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ~Served() {
    http.stop();
    thread_.join();
  }

  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(port); }

  /// Returns the text of a request. \param line  method and target. \param headers  further
  /// headers, each with its line break.
  [[nodiscard]] std::string text(const std::string& line, const std::string& headers = "",
                                 const std::string& body = "", bool with_token = true) const {
    std::string request = line + " HTTP/1.1\r\nHost: " + host() + "\r\nConnection: close\r\n";
    if (with_token) request += "X-Lefort-Token: " + kToken + "\r\n";
    if (!body.empty()) request += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    return request + headers + "\r\n" + body;
  }
  /// Returns the response to raw bytes.
  [[nodiscard]] std::string exchange(const std::string& bytes) const {
    const Socket socket(port);
    socket.send(bytes);
    return socket.receive();
  }
  [[nodiscard]] std::string call_api(const std::string& line, const std::string& headers = "",
                                     const std::string& body = "", bool with_token = true) const {
    return exchange(text(line, headers, body, with_token));
  }
  /// 0 if there was no response.
  [[nodiscard]] static int status_of(const std::string& reply) {
    return reply.size() > 12 && reply.starts_with("HTTP/1.1 ") ? std::stoi(reply.substr(9, 3)) : 0;
  }
  [[nodiscard]] int status(const std::string& line, const std::string& headers = "",
                           const std::string& body = "") const {
    return status_of(call_api(line, headers, body));
  }

  CaseApi own;
  server::HttpServer http;
  int port = 0;

 private:
  std::thread thread_;
};

}  // namespace lefort::test
