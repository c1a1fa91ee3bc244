#include <lefort/core/check.h>
#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/volumetric.h>

#include <cmath>

namespace lefort::fem {
namespace {

/// \returns x - ln(1 + x) without cancellation: with y = x / (2 + x),
/// ln(1 + x) = 2 (y + y^3/3 + y^5/5 + ...) and x - 2 y = x y.
double minus_log1p(double x) {
  constexpr double kSmall = 0.1;
  if (!(std::abs(x) < kSmall)) return x - std::log1p(x);
  const double y = x / (2.0 + x);
  const double y2 = y * y;
  const double series =
      1.0 / 3.0 + y2 * (1.0 / 5.0 + y2 * (1.0 / 7.0 + y2 * (1.0 / 9.0 + y2 * (1.0 / 11.0))));
  return y * (x - 2.0 * y2 * series);
}

}  // namespace

Result<void> Volumetric::validate() const {
  return check_positive("volumetric", "kappa", kappa_mpa);
}

double Volumetric::energy_minus_one(double change) const {
  switch (form) {
    case VolumetricForm::kQuadratic:
      return 0.5 * kappa_mpa * change * change;
    case VolumetricForm::kQuadraticLog:
      return 0.25 * kappa_mpa * (change * change + 2.0 * minus_log1p(change));
    case VolumetricForm::kLogSquared: {
      const double log_J = std::log1p(change);
      return 0.5 * kappa_mpa * log_J * log_J;
    }
  }
  throw_logic_error("form is known", __FILE__, __LINE__);
}

double Volumetric::dU_dJ(double J) const {
  LEFORT_ASSERT(J > 0.0);
  switch (form) {
    case VolumetricForm::kQuadratic:
      return kappa_mpa * (J - 1.0);
    case VolumetricForm::kQuadraticLog:
      return 0.5 * kappa_mpa * (J - 1.0) * (J + 1.0) / J;
    case VolumetricForm::kLogSquared:
      return kappa_mpa * std::log(J) / J;
  }
  throw_logic_error("form is known", __FILE__, __LINE__);
}

double Volumetric::d2U_dJ2(double J) const {
  LEFORT_ASSERT(J > 0.0);
  switch (form) {
    case VolumetricForm::kQuadratic:
      return kappa_mpa;
    case VolumetricForm::kQuadraticLog:
      return 0.5 * kappa_mpa * (1.0 + 1.0 / (J * J));
    case VolumetricForm::kLogSquared:
      return kappa_mpa * (1.0 - std::log(J)) / (J * J);
  }
  throw_logic_error("form is known", __FILE__, __LINE__);
}

}  // namespace lefort::fem
