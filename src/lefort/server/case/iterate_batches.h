/// \file
/// Newton's iterations as they come, a few at a time: small models have thousands a second.
#pragma once

#include <nlohmann/json.hpp>

#include <chrono>
#include <functional>

namespace lefort::server {

/// Hands on what it is given in batches, no more often than every kPause; the rest at flush().
class IterateBatches {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr auto kPause = std::chrono::milliseconds(100);

  /// \param tell  told an array of iterates, in the order in which they came.
  explicit IterateBatches(std::function<void(nlohmann::json iterates)> tell)
      : tell_(std::move(tell)) {}

  void add(nlohmann::json iterate, Clock::time_point now = Clock::now());

  /// Hands on what has waited, if anything.
  void flush(Clock::time_point now = Clock::now());

 private:
  std::function<void(nlohmann::json)> tell_;
  nlohmann::json waiting_ = nlohmann::json::array();
  Clock::time_point told_ = Clock::time_point::min();
};

}  // namespace lefort::server
