#include <lefort/fem/materials/constants.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::fem {
namespace {

/// Tolerance of the length of unit vectors, which may come from files.
constexpr double kUnitTolerance = 1e-9;

}  // namespace

Result<void> check_positive(std::string_view law, std::string_view constant, double value_mpa) {
  if (!(value_mpa > 0.0) || !std::isfinite(value_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {} is {:g} MPa, must be > 0", law, constant, value_mpa));
  return {};
}

Result<void> check_not_negative(std::string_view law, std::string_view constant, double value_mpa) {
  if (!(value_mpa >= 0.0) || !std::isfinite(value_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {} is {:g} MPa, must be >= 0", law, constant, value_mpa));
  return {};
}

Result<void> check_unit(std::string_view law, std::string_view direction, const Vec3& v) {
  const double length = v.norm();
  if (!(std::abs(length - 1.0) <= kUnitTolerance))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {} is ({}, {}, {}) of length {}, must be a unit vector", law,
                            direction, v.x(), v.y(), v.z(), length));
  return {};
}

Result<LameConstants> LameConstants::from_young_poisson(std::string_view law, double young_mpa,
                                                        double poisson) {
  LEFORT_TRY_VOID(check_positive(law, "young's modulus", young_mpa));
  if (poisson >= 0.5)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: poisson's ratio is {}, must be < 0.5; (nearly) incompressible "
                            "tissue needs a decoupled law, with a bulk modulus",
                            law, poisson));
  if (!(poisson > -1.0))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: poisson's ratio is {}, must be in (-1, 0.5)", law, poisson));
  return LameConstants{
      .mu_mpa = young_mpa / (2.0 * (1.0 + poisson)),
      .lambda_mpa = young_mpa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))};
}

Result<void> LameConstants::validate(std::string_view law) const {
  LEFORT_TRY_VOID(check_positive(law, "mu", mu_mpa));
  if (!(lambda_mpa > -2.0 / 3.0 * mu_mpa) || !std::isfinite(lambda_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: lambda is {} MPa, must be > -2/3 mu = {} MPa", law, lambda_mpa,
                            -2.0 / 3.0 * mu_mpa));
  return {};
}

}  // namespace lefort::fem
