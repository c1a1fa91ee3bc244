/// \file
/// What the last solve has told so far: for pages that come in the middle of it.
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>

namespace lefort::server {

/// Safe from many threads.
class SolveHistory {
 public:
  static constexpr std::size_t kMaxIterates = 50'000;  ///< As the contract says; the oldest go.

  /// Forgets what another job has told.
  void begin(int job);

  /// \param iterates  an array.
  /// \returns how many of this solve came before them.
  std::size_t add_iterates(const nlohmann::json& iterates);
  void add_step(nlohmann::json step);

  /// contract/openapi.json, SolveHistory; nothing unless that job is the last.
  [[nodiscard]] std::optional<nlohmann::json> of(int job) const;

 private:
  mutable std::mutex mutex_;
  int job_ = 0;
  std::size_t forgotten_ = 0;  ///< Iterates before those that are kept.
  std::deque<nlohmann::json> iterates_;
  nlohmann::json steps_ = nlohmann::json::array();
};

}  // namespace lefort::server
