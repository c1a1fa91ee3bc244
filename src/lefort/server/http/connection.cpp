#include <lefort/server/http/connection.h>

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace lefort::server {
namespace {

constexpr std::size_t kBuffer = 16 << 10;    // Bytes read at a time.
constexpr std::size_t kDrained = 256 << 10;  // Bytes of a rejected body that are read.
constexpr auto kDrainTime = std::chrono::milliseconds(500);
constexpr auto kReplyGrace = std::chrono::seconds(1);

std::chrono::milliseconds time_for(double bytes, double bytes_per_s) {
  return std::chrono::milliseconds(std::int64_t(1000.0 * bytes / bytes_per_s));
}

}  // namespace

Connection::Connection(int socket, const HttpLimits& limits) : socket_(socket), limits_(limits) {}

bool Connection::wait_for_request() {
  phase_ = Phase::kHeader;
  is_line_start_ = true;
  moved_ = 0.0;
  since_ = Clock::now();  // Before waiting: not since the previous request.
  is_waiting_ = true;
  const bool is_here = at_ < buffer_.size() || wait_for(POLLIN, Clock::now() + limits_.idle_time);
  begun_ = Clock::now();
  since_ = begun_;
  return is_here;
}

void Connection::begin_body() {
  is_waiting_ = false;
  phase_ = Phase::kBody;
  begun_ = Clock::now();
  moved_ = 0.0;
}

void Connection::abort() const { ::shutdown(socket_, SHUT_RDWR); }

void Connection::drain() {
  ::shutdown(socket_, SHUT_WR);
  const auto until = Clock::now() + kDrainTime;
  char nothing[4096];
  for (std::size_t taken = 0; taken < kDrained && wait_for(POLLIN, until);) {
    const ssize_t count = ::recv(socket_, nothing, sizeof(nothing), MSG_DONTWAIT);
    if (count <= 0) return;
    taken += std::size_t(count);
  }
}

Connection::Clock::time_point Connection::deadline() const {
  const auto now = Clock::now();
  if (phase_ == Phase::kHeader) return begun_ + limits_.header_time;
  const auto stalled = now + limits_.stall_time;
  if (phase_ == Phase::kEvents) return stalled;
  const auto too_slow =
      begun_ + limits_.stall_time + time_for(moved_, limits_.min_throughput_bytes_per_s);
  return std::min(stalled, too_slow);
}

bool Connection::wait_for(short events, Clock::time_point until) const {
  while (true) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    if (left < 0) return false;
    pollfd descriptor{socket_, events, 0};
    const int ready = ::poll(&descriptor, 1, int(std::min<std::int64_t>(left + 1, 60'000)));
    if (ready > 0) return (descriptor.revents & (events | POLLHUP)) != 0;
    if (ready < 0 && errno != EINTR) return false;
  }
}

bool Connection::is_readable() const {
  return at_ < buffer_.size() || wait_for(POLLIN, deadline());
}

bool Connection::is_writable() const {
  if (phase_ == Phase::kEvents) {  // Polled: whether the page is still connected.
    pollfd descriptor{socket_, POLLRDHUP, 0};
    if (::poll(&descriptor, 1, 0) > 0) return false;
  }
  return wait_for(POLLOUT, Clock::now() + limits_.stall_time);
}

ssize_t Connection::receive() {
  if (!wait_for(POLLIN, deadline())) return -1;
  buffer_.erase(0, at_);
  at_ = 0;
  const std::size_t held = buffer_.size();
  buffer_.resize(held + kBuffer);
  const ssize_t count = ::recv(socket_, buffer_.data() + held, kBuffer, 0);
  buffer_.resize(held + std::size_t(std::max<ssize_t>(count, 0)));
  return count;
}

/// Renames the header "Range" at the start of a line, which this server does not support. httplib
/// parses it by a regular expression, recursively for each character, before any check of ours
/// (fixed by its pull request 1812).
void Connection::hide_range() {
  constexpr std::string_view kRange = "range:";
  const auto rest = [this] { return std::string_view(buffer_).substr(at_); };
  const auto is_beginning = [&] {
    const std::string_view start = rest().substr(0, kRange.size());
    return std::equal(start.begin(), start.end(), kRange.begin(),
                      [](char c, char lower) { return std::tolower(std::uint8_t(c)) == lower; });
  };
  while (is_beginning()) {
    if (rest().size() >= kRange.size()) buffer_[at_] = 'x';
    if (rest().size() < kRange.size() && receive() <= 0) return;
  }
}

ssize_t Connection::read(char* to, size_t size) {
  if (at_ == buffer_.size())
    if (const ssize_t count = receive(); count <= 0) return count;
  const bool in_header = phase_ == Phase::kHeader;
  if (in_header && is_line_start_) hide_range();
  // Of a header, at most one line.
  const std::size_t end =
      in_header ? std::min(buffer_.find('\n', at_), buffer_.size() - 1) + 1 : buffer_.size();
  const std::size_t taken = std::min(size, end - at_);
  is_line_start_ = in_header && taken > 0 && buffer_[at_ + taken - 1] == '\n';
  moved_ += double(taken);
  if (phase_ == Phase::kHeader && moved_ > double(limits_.header_bytes)) return -1;
  std::memcpy(to, buffer_.data() + at_, taken);
  at_ += taken;
  return ssize_t(taken);
}

ssize_t Connection::write(const char* from, size_t size) {
  if (phase_ == Phase::kHeader || phase_ == Phase::kBody) {
    is_waiting_ = false;
    phase_ = Phase::kReply;
    begun_ = Clock::now();
    moved_ = 0.0;
  }
  // A client that does not read is evicted if others wait for the thread.
  since_ = Clock::now() + kReplyGrace;
  is_waiting_ = true;
  const bool is_ready = wait_for(POLLOUT, deadline());
  is_waiting_ = false;
  if (!is_ready) return -1;
  const ssize_t count = ::send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (count > 0) moved_ += double(count);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
  return count;
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip.clear();  // The address is not needed.
  port = 0;
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

}  // namespace lefort::server
