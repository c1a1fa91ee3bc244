/// \file
/// Run time of each phase of a solve.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// Sums the wall-clock time of named phases; one runs at a time.
class PhaseClock {
 public:
  /// Ends the current phase and begins `name`.
  void begin(const std::string& name) {
    const auto now = Clock::now();
    if (current_ < seconds_.size())
      seconds_[current_].second += std::chrono::duration<double>(now - begun_).count();
    begun_ = now;
    for (current_ = 0; current_ < seconds_.size(); ++current_)
      if (seconds_[current_].first == name) return;
    seconds_.emplace_back(name, 0.0);
  }

  /// Name and seconds of each phase, in order of first use. The current period of the current phase
  /// is not included.
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& seconds() const {
    return seconds_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<std::pair<std::string, double>> seconds_;
  std::size_t current_ = 0;
  Clock::time_point begun_ = Clock::now();
};

}  // namespace lefort::pipeline
