/// \file
/// Factor of a load or displacement as a function of the time of a deck; the time is 0 to 1.
#pragma once

#include <lefort/core/error.h>

#include <string>
#include <vector>

namespace lefort::solve {

/// A point of a load curve.
struct CurvePoint {
  double time = 0.0;
  double factor = 0.0;
};

/// The default curve: the factor equals the time.
[[nodiscard]] std::vector<CurvePoint> ramp();

/// Linear between its points, constant before the first and after the last.
struct LoadCurve {
  std::vector<CurvePoint> points = ramp();
};

/// \returns nothing; or kPlanInvalid: no point, a number that is not finite, or times that do not
///   ascend or lie outside 0 to 1.
[[nodiscard]] Result<void> check_curve(const LoadCurve& curve);

/// \param curve  passes check_curve().
/// \param time   0 to 1.
[[nodiscard]] double factor_at(const LoadCurve& curve, double time);

}  // namespace lefort::solve
