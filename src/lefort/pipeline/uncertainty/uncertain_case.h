/// \file
/// A case with uncertain inputs: the design of its samples, the skin at which they are evaluated,
/// and their solution.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/uncertainty.h>
#include <lefort/pipeline/uncertainty/face_variant.h>
#include <lefort/pipeline/uncertainty/sample_store.h>
#include <lefort/pipeline/uncertainty/uncertain_inputs.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// The skin of the plan, and its vertices at which samples are evaluated.
struct SampledSkin {
  geometry::TriangleMesh skin_L;
  std::vector<Vec3> nominal_mm;  ///< Nominal displacement of every vertex, coarse model.
  /// Unit normals of the skin displaced by it, one per vertex; zero without a triangle.
  std::vector<Vec3> normals_L;
  std::vector<std::int32_t> vertices;  ///< That the tissue mesh can move.
  std::vector<double> area_mm2;        ///< One per entry of `vertices`.
  std::vector<char> is_moved;          ///< The nominal displacement exceeds 0.5 mm; as `vertices`.
};

/// All samples of a kind.
struct SolvedSamples {
  std::vector<Index> numbers;         ///< Rows of the design; ascending.
  std::vector<SampleResult> results;  ///< One per number.
};

/// Prepares the case at the middle level of all inputs, and others when they are needed.
class UncertainCase {
 public:
  [[nodiscard]] static Result<std::unique_ptr<UncertainCase>> open(const UncertaintyJob& job,
                                                                   Progress& progress);

  /// Solves all samples that are not stored; of a chunk only those of the chunk.
  [[nodiscard]] Result<SolvedSamples> solve_coarse(Progress& progress);
  /// On the mesh of the plan: the first samples of the middle level; the other ones are not used,
  /// because each level would need a fine mesh of its own.
  [[nodiscard]] Result<SolvedSamples> solve_fine(Progress& progress);
  /// The first samples along the whole path.
  [[nodiscard]] Result<SolvedSamples> solve_paths(Progress& progress);

  [[nodiscard]] const std::vector<InputEntry>& entries() const { return entries_; }
  [[nodiscard]] const InputsOfPlan& inputs() const { return inputs_; }
  [[nodiscard]] const Eigen::MatrixXd& points() const { return points_; }
  [[nodiscard]] const SampledSkin& skin() const { return skin_; }
  [[nodiscard]] const PreparedCase& prepared() const { return *prepared_; }
  [[nodiscard]] const FaceVariant& middle() const { return *variants_.at(middle_key_); }
  [[nodiscard]] const std::string& plan_text() const { return plan_text_; }
  /// Of the file of the scan; nothing if the scan is a folder.
  [[nodiscard]] const std::optional<std::string>& ct_file_sha256() const { return ct_file_sha256_; }
  /// \returns nothing; kPlanInvalid if the scan or a file that the plan names has changed since
  ///   open(), so that it is not known which of its versions the samples are of.
  [[nodiscard]] Result<void> check_unchanged() const;
  /// Number of combinations of levels in the design.
  [[nodiscard]] std::size_t model_count() const;

 private:
  explicit UncertainCase(const UncertaintyJob& job)
      : job_(job), cache_(job.output / "cache"), store_(job.output, std::string(16, '0')) {}

  [[nodiscard]] Result<void> prepare(Progress& progress);
  void find_skin();
  [[nodiscard]] Result<PreparedCase> prepare_anatomy(const VariantKey& key, Progress& progress);
  [[nodiscard]] Result<void> prepare_variants(std::span<const Index> samples, Progress& progress);
  [[nodiscard]] VariantKey key_of(Index sample) const;
  [[nodiscard]] std::vector<double> values_of(Index sample) const;
  [[nodiscard]] Result<SampleResult> solve_one(const FaceVariant& variant, Index sample,
                                               StartState start, Progress& progress) const;
  [[nodiscard]] Result<SolvedSamples> solve(const std::string& kind, std::vector<Index> numbers,
                                            const FaceVariant* variant, StartState start,
                                            Progress& progress);

  UncertaintyJob job_;
  StageCache cache_;
  SampleStore store_;
  std::filesystem::path ct_;
  std::optional<std::string> ct_file_sha256_;
  std::vector<io::InputFile> plan_files_;
  std::string plan_text_;
  io::PlanFile plan_;
  std::vector<InputEntry> entries_;
  InputsOfPlan inputs_;
  Eigen::MatrixXd points_;  ///< Samples by inputs.
  std::optional<PreparedCase> prepared_;
  SampledSkin skin_;
  VariantKey middle_key_;
  std::map<VariantKey, std::unique_ptr<FaceVariant>> variants_;
  std::map<VariantKey, std::string> failed_variants_;
};

}  // namespace lefort::pipeline
