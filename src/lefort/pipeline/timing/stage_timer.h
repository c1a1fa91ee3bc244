/// \file
/// Progress that measures the time of each stage.
#pragma once

#include <lefort/core/progress.h>

#include <nlohmann/json.hpp>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// Forwards everything to another Progress and measures the wall-clock time of each stage.
class StageTimer final : public Progress {
 public:
  explicit StageTimer(Progress& shown) : shown_(shown) {}

  void begin_stage(std::string_view name) override {
    stages_ = stages();
    stages_.emplace_back(name, 0.0);
    begun_ = Clock::now();
    shown_.begin_stage(name);
  }
  void report(double fraction) override { shown_.report(fraction); }
  void note(std::string_view sentence) override { shown_.note(sentence); }
  [[nodiscard]] bool stop_requested() const override { return shown_.stop_requested(); }

  /// As stages(): seconds by name, and their total, as JSON.
  [[nodiscard]] nlohmann::ordered_json seconds_json() const {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    double total = 0.0;
    for (const auto& [name, seconds] : stages()) {
      json[name] = json.value(name, 0.0) + seconds;
      total += seconds;
    }
    json["total"] = total;
    return json;
  }

  /// Name and seconds of every stage so far, the current one included.
  [[nodiscard]] std::vector<std::pair<std::string, double>> stages() const {
    auto stages = stages_;
    if (!stages.empty())
      stages.back().second = std::chrono::duration<double>(Clock::now() - begun_).count();
    return stages;
  }

 private:
  using Clock = std::chrono::steady_clock;

  Progress& shown_;
  std::vector<std::pair<std::string, double>> stages_;  ///< The last one without its time.
  Clock::time_point begun_;
};

}  // namespace lefort::pipeline
