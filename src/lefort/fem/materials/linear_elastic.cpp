#include <lefort/fem/materials/linear_elastic.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::fem {
namespace {

/// The small strain, eps = (F + F^T)/2 - I.
Mat3 small_strain(const Mat3& F) { return 0.5 * (F + F.transpose()) - Mat3::Identity(); }

}  // namespace

Result<LinearElastic> LinearElastic::from_young_poisson(double young_mpa, double poisson) {
  if (!(young_mpa > 0.0) || !std::isfinite(young_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("linear elastic: young's modulus is {} MPa, must be > 0", young_mpa));
  if (!(poisson > -1.0 && poisson < 0.5))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("linear elastic: poisson's ratio is {}, must be in (-1, 0.5)", poisson));
  return LinearElastic{
      .mu_mpa = young_mpa / (2.0 * (1.0 + poisson)),
      .lambda_mpa = young_mpa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))};
}

Result<void> LinearElastic::validate() const {
  if (!(mu_mpa > 0.0) || !std::isfinite(mu_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("linear elastic: mu is {} MPa, must be > 0", mu_mpa));
  if (!(lambda_mpa > -2.0 / 3.0 * mu_mpa) || !std::isfinite(lambda_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("linear elastic: lambda is {} MPa, must be > -2/3 mu = {} MPa",
                            lambda_mpa, -2.0 / 3.0 * mu_mpa));
  return {};
}

double LinearElastic::energy(const Mat3& F) const {
  const Mat3 strain = small_strain(F);
  const double trace = strain.trace();
  return mu_mpa * strain.squaredNorm() + 0.5 * lambda_mpa * trace * trace;
}

Mat3 LinearElastic::stress(const Mat3& F) const {
  const Mat3 strain = small_strain(F);
  return 2.0 * mu_mpa * strain + lambda_mpa * strain.trace() * Mat3::Identity();
}

Mat9 LinearElastic::tangent(const Mat3& /*F*/) const {
  const Vec9 identity = flatten(Mat3::Identity());
  Mat9 A = lambda_mpa * identity * identity.transpose();
  // 2 mu d(eps) = mu (dF + dF^T).
  for (int K = 0; K < 3; ++K) {
    for (int k = 0; k < 3; ++k) {
      A(k + 3 * K, k + 3 * K) += mu_mpa;
      A(K + 3 * k, k + 3 * K) += mu_mpa;
    }
  }
  return A;
}

}  // namespace lefort::fem
