/// \file
/// The inputs of a prediction that can be uncertain: one table.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/io/plan_file.h>
#include <lefort/uncertainty/chaos_basis.h>
#include <lefort/uncertainty/distribution.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// What an input changes.
enum class InputEffect {
  kForces,    ///< Materials and stiffnesses: the prepared model is used again.
  kPose,      ///< The final pose of a segment.
  kBoundary,  ///< Boundary conditions of the same mesh.
  kAnatomy,   ///< Segmentation or cut: everything is prepared again.
};

/// A kind of input.
struct InputParameter {
  const char* name;
  const char* meaning;
  const char* unit;   ///< Empty for ratios.
  const char* group;  ///< Of inputs whose indices are also summed: "tissue", "execution", ...
  InputEffect effect;
  double low, high;  ///< Values outside are errors.
};

[[nodiscard]] std::span<const InputParameter> input_parameters();

/// An entry of a file of inputs.
struct InputEntry {
  const InputParameter* parameter = nullptr;
  uncertainty::Distribution distribution{};
  std::optional<std::string> segment{};
  int levels = 3;
  std::string source;
};

/// One random number. The execution error of a segment has six.
struct UncertainInput {
  std::string name;  ///< "poisson", or "midface right-left [mm]".
  const InputParameter* parameter = nullptr;
  uncertainty::Distribution distribution{};
  /// The distribution of the samples: that of the input, or its levels if `is_in_levels()`.
  uncertainty::Distribution sampled{};
  std::string source;
  std::size_t segment = 0;  ///< Of an execution error.
  int axis = 0;             ///< Of L; of an execution error.

  [[nodiscard]] bool is_in_levels() const {
    return parameter->effect == InputEffect::kBoundary ||
           parameter->effect == InputEffect::kAnatomy;
  }
  /// Of the polynomials.
  [[nodiscard]] int max_degree() const;
  /// The middle level, the median of other distributions.
  [[nodiscard]] double center() const;
};

/// The entries that are used without a file, and their sources; the execution error by \cite
/// hsu2013.
[[nodiscard]] std::vector<InputEntry> default_inputs(const io::PlanFile& plan);

/// Reads a file of inputs (contract/uncertain_inputs.schema.json).
///
/// \returns the entries; kFileNotFound, kFileCorrupt, or kPlanInvalid or kInvalidArgument with the
///   entry and its error.
[[nodiscard]] Result<std::vector<InputEntry>> read_inputs(const std::filesystem::path& file);

/// The random numbers of the entries for a plan, and why entries have no effect on it.
struct InputsOfPlan {
  std::vector<UncertainInput> inputs;
  std::vector<std::string> without_effect;  ///< "skin_ratio_factor: the plan has no skin".
};

/// Checks each value of a design against the range of its parameter. The quantiles that
/// inputs_of_plan() checks are not enough: levels and a long tail lie beyond them.
///
/// \param points  samples by inputs.
/// \returns nothing, or kInvalidArgument with the first sample out of range.
[[nodiscard]] Result<void> check_design(std::span<const UncertainInput> inputs,
                                        const Eigen::MatrixXd& points);

/// \returns the inputs; kInvalidArgument if a segment is unknown, a parameter is given twice, a
///   quantile of 0.1 % or 99.9 % is out of range, or no input has an effect.
[[nodiscard]] Result<InputsOfPlan> inputs_of_plan(std::span<const InputEntry> entries,
                                                  const io::PlanFile& plan);

}  // namespace lefort::pipeline
