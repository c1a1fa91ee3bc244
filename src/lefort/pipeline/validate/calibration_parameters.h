/// \file
/// The parameters that `lefort calibrate` can fit: one table.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/io/plan_file.h>

#include <nlohmann/json.hpp>

#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// A bounded parameter of a prediction.
struct CalibrationParameter {
  const char* name;
  const char* meaning;  ///< With its unit.
  double low, high;     ///< Bounds.
  bool is_logarithmic;  ///< Fitted as a logarithm.
  double step;          ///< Of finite differences: of the parameter, or of its logarithm.
  bool changes_mesh;    ///< Mesh or boundary conditions depend on it, not only forces.
  double (*get)(const io::PlanFile&);
  void (*set)(io::PlanFile&, double);
  /// The keys of a plan that set this value; other values in these keys are those of `plan`.
  nlohmann::ordered_json (*keys)(const io::PlanFile& plan, double);

  /// Coordinate from 0 to 1 between the bounds; clamped.
  [[nodiscard]] double coordinate(double value) const;
  [[nodiscard]] double value(double coordinate) const;
  /// `step` as a difference of coordinates.
  [[nodiscard]] double coordinate_step() const;
};

/// All parameters.
[[nodiscard]] std::span<const CalibrationParameter> calibration_parameters();

/// Names of the parameters that are fitted unless others are named.
[[nodiscard]] std::vector<std::string> default_parameters();

/// \param names  of the table.
/// \returns the parameters in the order of the names; kInvalidArgument for a name that is unknown
///   or repeated.
[[nodiscard]] Result<std::vector<CalibrationParameter>> find_parameters(
    std::span<const std::string> names);

}  // namespace lefort::pipeline
