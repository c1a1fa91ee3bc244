#include <lefort/core/check.h>
#include <lefort/core/decompositions.h>
#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/ogden.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::fem {
namespace {

bool is_absent(const OgdenTerm& term) { return term.mu_mpa == 0.0 && term.alpha == 0.0; }

/// \returns e^x - 1 - x without cancellation.
double exp_minus_line(double x) {
  constexpr double kSmall = 0.5;
  if (!(std::abs(x) < kSmall)) return std::expm1(x) - x;
  constexpr int kTerms = 14;  // 0.5^14 / 16! < 1e-17.
  double nested = 1.0;
  for (int n = kTerms + 2; n > 2; --n) nested = 1.0 + nested * x / n;
  return 0.5 * x * x * nested;
}

/// \returns (e^(alpha d) - 1) / (e^(2 d) - 1); alpha / 2 for d = 0.
double quotient(double alpha, double d) {
  return d == 0.0 ? 0.5 * alpha : std::expm1(alpha * d) / std::expm1(2.0 * d);
}

/// \returns the logarithms of the isochoric principal stretches.
Vec3 isochoric(const Vec3& log_stretch) { return log_stretch.array() - log_stretch.mean(); }

/// Principal stretches l_i of F, from C - I: accurate for stretches near 1.
struct PrincipalStretches {
  explicit PrincipalStretches(const Mat3& F) {
    const Mat3 H = F - Mat3::Identity();
    const Mat3 twice_E = H + H.transpose() + H.transpose() * H;
    // The iterative solver: its directions are orthonormal at nearly equal stretches, too.
    const SymmetricEigen<3> principal = symmetric_eigen(twice_E);
    log_stretch = 0.5 * principal.values.array().log1p();
    at_rest = principal.vectors;
    deformed = F * at_rest * (-log_stretch.array()).exp().matrix().asDiagonal();
  }

  Vec3 log_stretch;  ///< ln l_i.
  Mat3 at_rest;      ///< Columns N_i, unit vectors.
  Mat3 deformed;     ///< Columns n_i, where F N_i = l_i n_i.
};

/// tau_i = dPsi/d(ln l_i) = beta_i - mean beta, beta_i = sum of mu_p l_i^alpha_p, l_i isochoric;
/// computed from beta_i minus its value at F = I, so that it vanishes there.
Vec3 principal_kirchhoff_stress(const Ogden& law, const Vec3& log_isochoric) {
  Vec3 beta = Vec3::Zero();
  for (const OgdenTerm& term : law.terms)
    for (int i = 0; i < 3; ++i) beta[i] += term.mu_mpa * std::expm1(term.alpha * log_isochoric[i]);
  return isochoric(beta);
}

}  // namespace

Result<void> Ogden::validate() const {
  for (std::size_t p = 0; p < terms.size(); ++p) {
    const auto [mu_mpa, alpha] = terms[p];
    if (p > 0 && is_absent(terms[p])) continue;
    if (!std::isfinite(mu_mpa) || !std::isfinite(alpha))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("ogden: mu_{} is {} MPa and alpha_{} is {}, must be finite", p + 1,
                              mu_mpa, p + 1, alpha));
    if (!(mu_mpa * alpha > 0.0))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("ogden: mu_{} * alpha_{} is {} * {} = {} MPa, must be > 0", p + 1,
                              p + 1, mu_mpa, alpha, mu_mpa * alpha));
  }
  return {};
}

double Ogden::shear_modulus_mpa() const {
  double sum = 0.0;
  for (const OgdenTerm& term : terms) sum += 0.5 * term.mu_mpa * term.alpha;
  return sum;
}

double Ogden::energy(const Mat3& F) const {
  LEFORT_ASSERT(volume_ratio(F) > 0.0);
  const Vec3 log_isochoric = isochoric(PrincipalStretches(F).log_stretch);
  double sum = 0.0;
  for (const OgdenTerm& term : terms) {
    if (is_absent(term)) continue;
    // The terms of first order, alpha ln l_i, add to zero and are omitted.
    double powers = 0.0;
    for (const double x : log_isochoric) powers += exp_minus_line(term.alpha * x);
    sum += term.mu_mpa / term.alpha * powers;
  }
  return sum;
}

Mat3 Ogden::stress(const Mat3& F) const {
  LEFORT_ASSERT(volume_ratio(F) > 0.0);
  const PrincipalStretches principal(F);
  const Vec3 tau = principal_kirchhoff_stress(*this, isochoric(principal.log_stretch));
  const Vec3 p = tau.array() * (-principal.log_stretch.array()).exp();
  return principal.deformed * p.asDiagonal() * principal.at_rest.transpose();
}

Mat9 Ogden::tangent(const Mat3& F) const {
  LEFORT_ASSERT(volume_ratio(F) > 0.0);
  const PrincipalStretches principal(F);
  const Vec3 log_isochoric = isochoric(principal.log_stretch);
  const Vec3 tau = principal_kirchhoff_stress(*this, log_isochoric);
  const Vec3 stretch = principal.log_stretch.array().exp();

  // Part of dF along the axes: d2Psi/dl_i dl_j.
  Vec3 gamma = Vec3::Zero();  // d(beta_i)/d(ln l_i).
  for (const OgdenTerm& term : terms)
    gamma.array() += term.mu_mpa * term.alpha * (term.alpha * log_isochoric.array()).exp();
  const double mean = gamma.mean();
  Mat3 H;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) H(i, j) = (mean - gamma[i] - gamma[j]) / 3.0;
  H.diagonal() += gamma - tau;
  H.array() /= (stretch * stretch.transpose()).array();

  Eigen::Matrix<double, 9, 9> axis;  // Column i + 3 j: n_i N_j^T.
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      axis.col(i + 3 * j) =
          flatten(principal.deformed.col(i) * principal.at_rest.col(j).transpose());
  Mat9 in_axes = Mat9::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) in_axes(4 * i, 4 * j) = H(i, j);

  // Part of dF that rotates axis i towards axis j: with d = (tau_i - tau_j) / (l_i^2 - l_j^2),
  // dP_ij = d dF_ij + (l_j/l_i d - tau_j / (l_i l_j)) dF_ji.
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) {
      const double difference = principal.log_stretch[i] - principal.log_stretch[j];
      double d = 0.0;
      for (const OgdenTerm& term : terms)
        d += term.mu_mpa * std::exp(term.alpha * log_isochoric[j]) *
             quotient(term.alpha, difference);
      d /= stretch[j] * stretch[j];
      const double crossed = (stretch[j] * stretch[j] * d - tau[j]) / (stretch[i] * stretch[j]);
      const int ij = i + 3 * j;
      const int ji = j + 3 * i;
      in_axes(ij, ij) = in_axes(ji, ji) = d;
      in_axes(ij, ji) = in_axes(ji, ij) = crossed;
    }
  }
  const Mat9 half = axis * in_axes;
  return half * axis.transpose();
}

}  // namespace lefort::fem
