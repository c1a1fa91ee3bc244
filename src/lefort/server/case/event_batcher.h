/// \file
/// Newton iterations in batches: small models have thousands per second.
#pragma once

#include <nlohmann/json.hpp>

#include <chrono>
#include <functional>

namespace lefort::server {

/// Passes iterates on in batches, at most one batch per kPause; the rest at flush().
class EventBatcher {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr auto kPause = std::chrono::milliseconds(100);

  /// \param notify  called with an array of iterates, in order.
  explicit EventBatcher(std::function<void(nlohmann::json iterates)> notify)
      : report_(std::move(notify)) {}

  void add(nlohmann::json iterate, Clock::time_point now = Clock::now());

  /// Passes on all waiting iterates.
  void flush(Clock::time_point now = Clock::now());

 private:
  std::function<void(nlohmann::json)> report_;
  nlohmann::json pending_ = nlohmann::json::array();
  Clock::time_point last_report_ = Clock::time_point::min();
};

}  // namespace lefort::server
