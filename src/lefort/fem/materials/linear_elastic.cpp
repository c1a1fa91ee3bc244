#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/linear_elastic.h>

namespace lefort::fem {
namespace {

/// \returns the small strain eps = (F + F^T)/2 - I.
Mat3 small_strain(const Mat3& F) { return 0.5 * (F + F.transpose()) - Mat3::Identity(); }

}  // namespace

Result<LinearElastic> LinearElastic::from_young_poisson(double young_mpa, double poisson) {
  LEFORT_TRY(const LameConstants lame,
             LameConstants::from_young_poisson("linear elastic", young_mpa, poisson));
  return LinearElastic{.mu_mpa = lame.mu_mpa, .lambda_mpa = lame.lambda_mpa};
}

Result<void> LinearElastic::validate() const {
  return LameConstants{mu_mpa, lambda_mpa}.validate("linear elastic");
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
