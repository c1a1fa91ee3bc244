#include <lefort/solve/young_modulus_at_rest.h>

namespace lefort::solve {
namespace {

/// Index of component (i, J) of F or P in a fem::Mat9.
constexpr int at(int i, int J) { return i + 3 * J; }

/// Lame's constants [MPa].
struct Lame {
  double lambda = 0.0, mu = 0.0;
};

/// Means of the components that equal them in Hooke's law.
Lame lame_at_rest(const fem::Material& material) {
  const fem::Mat9 A =
      std::visit([](const auto& law) { return law.tangent(Mat3::Identity()); }, material);
  Lame mean;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      mean.lambda += A(at(i, i), at(j, j)) / 6.0;
      mean.mu += A(at(i, j), at(i, j)) / 6.0;
    }
  return mean;
}

}  // namespace

double young_modulus_at_rest_mpa(const fem::Material& material) {
  const auto [lambda, mu] = lame_at_rest(material);
  return mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
}

double poisson_ratio_at_rest(const fem::Material& material) {
  const auto [lambda, mu] = lame_at_rest(material);
  return 0.5 * lambda / (lambda + mu);
}

}  // namespace lefort::solve
