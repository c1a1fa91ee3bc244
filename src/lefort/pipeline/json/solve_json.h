/// \file
/// A run of `lefort solve` as JSON: inputs, results, and run times.
#pragma once

#include <lefort/io/deck_file.h>
#include <lefort/pipeline/timing/phase_clock.h>
#include <lefort/solve/run_deck.h>

#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// SHA-256 of the deck and its files.
struct SolveInputs {
  std::string deck_sha256;
  std::string mesh_sha256;
  std::vector<std::string> obstacle_sha256;  ///< For each obstacle of the deck.
};

/// One increment, for the list "increments".
[[nodiscard]] nlohmann::ordered_json increment_json(const solve::PreparedDeck& prepared,
                                                    const solve::Increment& increment);

/// The whole document.
///
/// \param increments  results of increment_json().
/// \param last_file   file of the last converged increment, if there is one.
[[nodiscard]] nlohmann::ordered_json solve_json(
    const io::DeckFile& file, const solve::PreparedDeck& prepared, const SolveInputs& inputs,
    nlohmann::ordered_json increments, const solve::DeckRun& run, const std::string& last_file,
    const PhaseClock& clock);

}  // namespace lefort::pipeline
