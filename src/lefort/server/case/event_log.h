/// \file
/// What happens, for pages that listen: the last events, numbered, so that a page that lost its
/// connection is told what it missed.
#pragma once

#include <nlohmann/json.hpp>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace lefort::server {

/// Safe from many threads; bounded.
class EventLog {
 public:
  /// \param start  8 hexadecimal digits that no other start of the server has.
  explicit EventLog(std::string start);

  void publish(std::string_view type, const nlohmann::json& data);

  /// Where a listener is that has heard all so far.
  [[nodiscard]] std::uint64_t now() const;

  /// Where a listener is that last heard `id` ("start.number"); nothing if that is not known here,
  /// or what followed is forgotten: then it has to fetch everything anew.
  [[nodiscard]] std::optional<std::uint64_t> find(std::string_view id) const;

  /// Waits until there is more than `heard`, or the time is over, or stop().
  ///
  /// \returns events as text/event-stream has them, perhaps none; moves `heard` on. One that is too
  ///   slow for the log is told to reset.
  [[nodiscard]] std::string wait(std::uint64_t& heard, std::chrono::milliseconds longest);

  /// The event that tells a page to fetch everything anew.
  [[nodiscard]] std::string reset_event() const;

  void stop();
  [[nodiscard]] bool is_stopped() const;
  [[nodiscard]] const std::string& start() const { return start_; }

 private:
  [[nodiscard]] std::string reset_event_at(std::uint64_t number) const;

  const std::string start_;
  mutable std::mutex mutex_;
  std::condition_variable more_;
  std::deque<std::string> texts_;  ///< Of events last_ - size + 1 to last_.
  std::size_t bytes_ = 0;
  std::uint64_t last_ = 0;
  bool is_stopped_ = false;
};

}  // namespace lefort::server
