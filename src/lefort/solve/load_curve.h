/// \file
/// How a load or a displacement comes in over the time of a deck, 0 to 1.
#pragma once

#include <lefort/core/error.h>

#include <string>
#include <vector>

namespace lefort::solve {

/// A corner of a curve.
struct CurvePoint {
  double time = 0.0;
  double factor = 0.0;
};

/// From 0 to 1 with time.
[[nodiscard]] std::vector<CurvePoint> ramp();

/// Straight between its points, constant before the first and after the last.
struct LoadCurve {
  std::vector<CurvePoint> points = ramp();
};

/// \returns nothing, or kPlanInvalid: no point, a number that is not finite, times that do not
///   ascend or lie outside 0 to 1.
[[nodiscard]] Result<void> check_curve(const LoadCurve& curve);

/// \param curve  passes check_curve().
[[nodiscard]] double factor_at(const LoadCurve& curve, double time);

}  // namespace lefort::solve
