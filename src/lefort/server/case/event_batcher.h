/// \file
/// Newton's iterations as they come, a few at a time: small models have thousands a second.
#pragma once

#include <nlohmann/json.hpp>

#include <chrono>
#include <functional>

namespace lefort::server {

/// Hands on what it is given in batches, no more often than every kPause; the rest at flush().
class EventBatcher {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr auto kPause = std::chrono::milliseconds(100);

  /// \param tell  told an array of iterates, in the order in which they came.
  explicit EventBatcher(std::function<void(nlohmann::json iterates)> notify)
      : report_(std::move(notify)) {}

  void add(nlohmann::json iterate, Clock::time_point now = Clock::now());

  /// Hands on what has waited, if anything.
  void flush(Clock::time_point now = Clock::now());

 private:
  std::function<void(nlohmann::json)> report_;
  nlohmann::json pending_ = nlohmann::json::array();
  Clock::time_point last_report_ = Clock::time_point::min();
};

}  // namespace lefort::server
