/// \file
/// Numbered log of the last events. A page that has lost its connection receives the events since
/// then.
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

/// Thread-safe; bounded.
class EventLog {
 public:
  /// \param start  8 hexadecimal digits that no other start of the server has.
  explicit EventLog(std::string start);

  void publish(std::string_view type, const nlohmann::json& data);

  /// Position after the last event.
  [[nodiscard]] std::uint64_t now() const;

  /// Position after the event `id` ("start.number"); nothing if there is no such event or later
  /// ones were removed: then the page must reload everything.
  [[nodiscard]] std::optional<std::uint64_t> find(std::string_view id) const;

  /// Waits until there are events after position `heard`, at most for `longest`, or until stop().
  ///
  /// \returns events as text/event-stream, perhaps none, and advances `heard`. A listener that is
  ///   too slow for the log receives the reset event.
  [[nodiscard]] std::string wait(std::uint64_t& heard, std::chrono::milliseconds longest);

  /// The event after which a page reloads everything.
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
