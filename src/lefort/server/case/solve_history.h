/// \file
/// Iterates and steps of the last solve, for pages that connect during the solve.
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>

namespace lefort::server {

/// Thread-safe.
class SolveHistory {
 public:
  static constexpr std::size_t kMaxIterates =
      50'000;  ///< As in the contract; the oldest are removed.

  /// Removes the history of the previous job.
  void begin(int job);

  /// \param iterates  an array.
  /// \returns the number of earlier iterates of this solve.
  std::size_t add_iterates(const nlohmann::json& iterates);
  void add_step(nlohmann::json step);

  /// contract/openapi.json, SolveHistory; nothing unless `job` is the last solve.
  [[nodiscard]] std::optional<nlohmann::json> of(int job) const;

 private:
  mutable std::mutex mutex_;
  int job_ = 0;
  std::size_t removed_ = 0;  ///< Number of removed iterates.
  std::deque<nlohmann::json> iterates_;
  nlohmann::json steps_ = nlohmann::json::array();
};

}  // namespace lefort::server
