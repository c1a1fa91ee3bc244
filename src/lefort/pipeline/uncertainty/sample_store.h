/// \file
/// Solved samples in files, so that an interrupted run, or several processes, need no sample twice.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// A sample that was solved, or why it has no result.
struct SampleResult {
  /// Displacement along the normal of each sampled vertex of the skin [mm]; empty with `failure`.
  std::vector<float> normal_mm{};
  std::string failure{};
  Index newton_iterations = 0;
  bool is_from_rest = false;  ///< The solve from the nominal equilibrium failed.

  [[nodiscard]] bool is_solved() const { return failure.empty(); }
};

/// A folder of samples; their key covers all that they depend on. Files are atomic and carry their
/// SHA-256: a damaged one is not read.
class SampleStore {
 public:
  /// \param key  hash of the inputs, 16 characters or more.
  SampleStore(const std::filesystem::path& folder, const std::string& key);

  /// \param kind    "coarse", "fine" or "path".
  /// \param sample  number of the sample.
  [[nodiscard]] std::optional<SampleResult> read(const std::string& kind, Index sample,
                                                 std::size_t vertices) const;

  /// \returns nothing, or kFileUnwritable.
  [[nodiscard]] Result<void> write(const std::string& kind, Index sample,
                                   const SampleResult& result) const;

 private:
  [[nodiscard]] std::filesystem::path file(const std::string& kind, Index sample) const;
  std::filesystem::path folder_;
};

}  // namespace lefort::pipeline
