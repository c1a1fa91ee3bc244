/// \file
/// Puts a run of `lefort solve` into its folder, step by step.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/deck_file.h>
#include <lefort/io/vtu.h>
#include <lefort/pipeline/json/solve_json.h>
#include <lefort/pipeline/timing/phase_clock.h>
#include <lefort/solve/run_deck.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// Refuses a folder where results would take the place of what the run is made from.
///
/// \param inputs  files that are read.
/// \returns nothing, or kFileUnwritable, naming the file.
[[nodiscard]] Result<void> spare_inputs(const std::filesystem::path& folder,
                                        std::span<const std::filesystem::path> inputs);

/// Takes an earlier run's results out of a folder, solve.json first.
///
/// Its own are the steps that solve.pvd or solve_incomplete.pvd lists, and what stands beside such
/// a list. A file of a result's name that is not one of them is somebody's own and not touched.
///
/// \returns nothing, or kFileUnwritable: there is such a file, or a result cannot be removed.
[[nodiscard]] Result<void> remove_solve_results(const std::filesystem::path& folder);

/// Writes step_NNNN.vtu as increments come, and the rest at the end.
///
/// The series is solve_incomplete.pvd until the run has reached time 1, and solve.pvd from then on,
/// so that nothing that ended early can pass for the result.
class SolveWriter {
 public:
  /// \param file, prepared  must outlive the writer.
  SolveWriter(std::filesystem::path folder, const io::DeckFile& file,
              const solve::PreparedDeck& prepared)
      : folder_(std::move(folder)), file_(file), prepared_(prepared) {}

  /// The body at rest, step 0.
  [[nodiscard]] Result<void> begin();

  /// The mesh, if the deck wants it at this time; the rest is remembered.
  [[nodiscard]] Result<void> add(const solve::Increment& increment);

  /// The last converged mesh if it was not written yet, probes.csv, and, last of all, solve.json:
  /// where it is, all the rest is.
  /// \returns what stands in solve.json.
  [[nodiscard]] Result<nlohmann::ordered_json> finish(const SolveInputs& inputs,
                                                      const solve::DeckRun& run,
                                                      const PhaseClock& clock);

  /// The last mesh that was written: once finish() is done, the last that converged.
  [[nodiscard]] std::filesystem::path last_step() const;

 private:
  [[nodiscard]] bool is_wanted(const solve::Increment& increment) const;
  [[nodiscard]] Result<void> write_step(int number, double time, const io::VtuFields& fields);
  [[nodiscard]] Result<void> complete_series() const;

  std::filesystem::path folder_;
  const io::DeckFile& file_;
  const solve::PreparedDeck& prepared_;
  std::vector<io::PvdEntry> series_;
  std::string probes_csv_;
  nlohmann::ordered_json increments_ = nlohmann::ordered_json::array();
  int last_written_ = 0;
};

}  // namespace lefort::pipeline
