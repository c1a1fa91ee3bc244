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
    end_stage();
    stages_.emplace_back(name, 0.0);
    begun_ = Clock::now();
    shown_.begin_stage(name);
  }
  void report(double fraction) override { shown_.report(fraction); }
  void note(std::string_view sentence) override { shown_.note(sentence); }
  [[nodiscard]] bool stop_requested() const override { return shown_.stop_requested(); }

  /// As stages(): seconds by name, and their total, as JSON.
  [[nodiscard]] nlohmann::ordered_json seconds_json() {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    double total = 0.0;
    for (const auto& [name, seconds] : stages()) {
      json[name] = json.value(name, 0.0) + seconds;
      total += seconds;
    }
    json["total"] = total;
    return json;
  }

  /// Name and seconds of every stage so far. Ends the current one: what follows is not measured
  /// until the next begin_stage().
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& stages() {
    end_stage();
    return stages_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void end_stage() {
    if (stages_.empty() || stages_.back().second > 0.0) return;
    stages_.back().second = std::chrono::duration<double>(Clock::now() - begun_).count();
  }

  Progress& shown_;
  std::vector<std::pair<std::string, double>> stages_;
  Clock::time_point begun_;
};

}  // namespace lefort::pipeline
