#include <lefort/solve/load_curve.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::solve {

std::vector<CurvePoint> ramp() { return {{0.0, 0.0}, {1.0, 1.0}}; }

Result<void> check_curve(const LoadCurve& curve) {
  const auto invalid = [](const std::string& why) { return fail(ErrorCode::kPlanInvalid, why); };
  if (curve.points.empty()) return invalid("the curve has no point; it needs at least one");
  double before = -std::numeric_limits<double>::infinity();
  for (const CurvePoint& point : curve.points) {
    if (!(point.time >= 0.0 && point.time <= 1.0))
      return invalid(fmt::format("a time of the curve is {}; it must be 0 to 1", point.time));
    if (!std::isfinite(point.factor))
      return invalid(fmt::format("a factor of the curve is {}; it must be finite", point.factor));
    if (!(point.time > before))
      return invalid(
          fmt::format("the times of the curve must ascend; {} comes after {}", point.time, before));
    before = point.time;
  }
  return {};
}

double factor_at(const LoadCurve& curve, double time) {
  const auto later =
      std::upper_bound(curve.points.begin(), curve.points.end(), time,
                       [](double t, const CurvePoint& point) { return t < point.time; });
  if (later == curve.points.begin()) return later->factor;
  const CurvePoint& earlier = *(later - 1);
  if (later == curve.points.end() || time == earlier.time) return earlier.factor;
  const double fraction = (time - earlier.time) / (later->time - earlier.time);
  return earlier.factor + fraction * (later->factor - earlier.factor);
}

}  // namespace lefort::solve
