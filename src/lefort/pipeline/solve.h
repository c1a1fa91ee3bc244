/// \file
/// Solution of a deck.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>

namespace lefort::pipeline {

struct SolveJob {
  bool quiet = false;  ///< Do not report each increment.
  std::filesystem::path deck;
  std::filesystem::path output;  ///< A folder; made if missing.
  bool check_only = false;       ///< Only read and check the deck.
};

/// Solves a deck; writes displacement, stress and reactions over time.
[[nodiscard]] Result<Summary> solve_deck(const SolveJob& job, Progress& progress);

}  // namespace lefort::pipeline
