#include <lefort/core/decompositions.h>
#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/fung_orthotropic.h>
#include <lefort/fem/materials/isochoric.h>

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace lefort::fem {
namespace {

constexpr const char* kName = "fung orthotropic";

/// Tolerance of scalar products of axes, which may come from files.
constexpr double kOrthogonalTolerance = 1e-9;

/// \returns M in 1/2 E_aa M_ab E_bb, the part of c Q / 2 without shear.
Mat3 normal_stiffness(const FungOrthotropic& law) {
  Mat3 M = law.lambda_mpa;
  M.diagonal() += 2.0 * law.mu_mpa;
  return M;
}

/// The exponent and its derivative at one F, along the material axes.
struct Exponent {
  Exponent(const FungOrthotropic& law, const Mat3& F)
      : E(0.5 * law.axes.transpose() * IsochoricStrain(F).twice_strain() * law.axes) {
    const Vec3 normal = normal_stiffness(law) * E.diagonal();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        T(a, b) = a == b ? normal[a] : (law.mu_mpa[a] + law.mu_mpa[b]) * E(a, b);
    Q = contract(T, E) / law.c_mpa;
  }

  Mat3 E;  ///< Green strain.
  Mat3 T;  ///< (c/2) dQ/dE: the stress without the factor e^Q.
  double Q = 0.0;
};

}  // namespace

Result<void> FungOrthotropic::validate() const {
  LEFORT_TRY_VOID(check_positive(kName, "c", c_mpa));
  for (int a = 0; a < 3; ++a)
    LEFORT_TRY_VOID(check_positive(kName, fmt::format("mu_{}", a + 1), mu_mpa[a]));
  if (!lambda_mpa.allFinite() || lambda_mpa != lambda_mpa.transpose())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: lambda has 12 {} and 21 {}, 23 {} and 32 {}, 31 {} and 13 {} MPa, "
                            "must be finite and symmetric",
                            kName, lambda_mpa(0, 1), lambda_mpa(1, 0), lambda_mpa(1, 2),
                            lambda_mpa(2, 1), lambda_mpa(2, 0), lambda_mpa(0, 2)));
  const double lowest_mpa = symmetric_eigen(normal_stiffness(*this)).values[0];
  if (!(lowest_mpa > 0.0))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: lambda plus 2 mu on its diagonal has the eigenvalue {} MPa, must "
                            "be positive definite",
                            kName, lowest_mpa));
  for (int a = 0; a < 3; ++a)
    LEFORT_TRY_VOID(check_unit(kName, fmt::format("axis {}", a + 1), axes.col(a)));
  const double skew = (axes.transpose() * axes - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(skew <= kOrthogonalTolerance))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: two axes have the scalar product {}, must be 0", kName, skew));
  return {};
}

double FungOrthotropic::energy(const Mat3& F) const {
  return 0.5 * c_mpa * std::expm1(Exponent(*this, F).Q);
}

Mat3 FungOrthotropic::stress(const Mat3& F) const {
  const IsochoricPart part(F);
  const Exponent at(*this, F);
  const Mat3 S = std::exp(at.Q) * axes * at.T * axes.transpose();
  return isochoric_stress(part, part.F_iso * S);
}

Mat9 FungOrthotropic::tangent(const Mat3& F) const {
  const IsochoricPart part(F);
  const Exponent at(*this, F);
  const double growth = std::exp(at.Q);
  const Mat3 T = axes * at.T * axes.transpose();
  const Mat3 FT = part.F_iso * T;

  // All in F_iso: P = F S, S = e^Q T, so dP = dF S + F dS, dS = e^Q (2/c (T : dE) T + dT).
  // With y_a = F times axis a, dE_ab = (y_a . dF axis_b + y_b . dF axis_a) / 2.
  const Mat3 y = part.F_iso * axes;
  Mat9 A = (2.0 / c_mpa) * flatten(FT) * flatten(FT).transpose();
  add_right_product(T, A);
  std::array<Vec9, 3> normal;
  for (int a = 0; a < 3; ++a) {
    normal[std::size_t(a)] = flatten(y.col(a) * axes.col(a).transpose());
    for (int b = 0; b < a; ++b) {
      const Vec9 shear =
          flatten(y.col(a) * axes.col(b).transpose() + y.col(b) * axes.col(a).transpose());
      A.noalias() += (0.5 * (mu_mpa[a] + mu_mpa[b])) * shear * shear.transpose();
    }
  }
  const Mat3 M = normal_stiffness(*this);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      A.noalias() += M(a, b) * normal[std::size_t(a)] * normal[std::size_t(b)].transpose();
  return isochoric_tangent(part, growth * FT, growth * A);
}

}  // namespace lefort::fem
