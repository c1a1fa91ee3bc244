/// \file
/// Writes a run of `lefort solve` into its folder, step by step.
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

/// Checks that no result of an earlier run, which would be removed, is an input of this run.
///
/// \param inputs  files that are read.
/// \returns nothing, or kFileUnwritable with the name of the file.
[[nodiscard]] Result<void> check_inputs_are_kept(const std::filesystem::path& folder,
                                                 std::span<const std::filesystem::path> inputs);

/// Removes the results of an earlier run, solve.json first.
///
/// Results are the steps listed in solve.pvd or solve_incomplete.pvd, and the other result files in
/// a folder with such a list. If another file has the name of a result, nothing is removed.
///
/// \returns nothing; or kFileUnwritable if there is such another file, or a result cannot be
///   removed.
[[nodiscard]] Result<void> remove_solve_results(const std::filesystem::path& folder);

/// Writes step_NNNN.vtu after each increment, and the other files at the end. The functions return
/// kFileUnwritable if a file cannot be written.
///
/// The series is solve_incomplete.pvd until the run has reached time 1, and solve.pvd from then on,
/// so that an incomplete run is not taken for a complete one.
class SolveWriter {
 public:
  /// \param file, prepared  must outlive the writer.
  SolveWriter(std::filesystem::path folder, const io::DeckFile& file,
              const solve::PreparedDeck& prepared)
      : folder_(std::move(folder)), file_(file), prepared_(prepared) {}

  /// Writes the reference configuration, step 0.
  [[nodiscard]] Result<void> begin();

  /// Writes the mesh, if the deck requests it at this time, and stores the values of the increment.
  [[nodiscard]] Result<void> add(const solve::Increment& increment);

  /// Writes the last converged mesh, unless it is written already, probes.csv, and last solve.json,
  /// which shows that all files are complete.
  /// \returns the content of solve.json.
  [[nodiscard]] Result<nlohmann::ordered_json> finish(const SolveInputs& inputs,
                                                      const solve::DeckRun& run,
                                                      const PhaseClock& clock);

  /// File of the last mesh that was written; after finish(), of the last converged increment.
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
