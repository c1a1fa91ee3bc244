/// \file
/// Models with closed forms of their statistics, for the tests of uncertainty.
#pragma once

#include <lefort/uncertainty/field_surrogate.h>
#include <lefort/uncertainty/latin_hypercube.h>
#include <lefort/uncertainty/sobol_indices.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace lefort::uncertainty {

inline Distribution uniform(double low, double high) {
  return {.kind = DistributionKind::kUniform, .low = low, .high = high};
}
inline Distribution normal(double mean, double deviation) {
  return {.kind = DistributionKind::kNormal, .mean = mean, .standard_deviation = deviation};
}

/// A design and the values of a scalar model, as a field of one point.
struct ModelRun {
  std::vector<ChaosInput> inputs;
  Eigen::MatrixXd points;
  VectorX values;
};

inline ModelRun run(const std::vector<Distribution>& distributions, Index count,
                    const std::function<double(const VectorX&)>& model, std::uint64_t seed = 1) {
  ModelRun made;
  for (const Distribution& one : distributions) made.inputs.push_back({one});
  made.points =
      points_at(distributions, nested_latin_hypercube(Index(distributions.size()), count, seed));
  made.values.resize(count);
  for (Index i = 0; i < count; ++i) made.values[i] = model(made.points.row(i).transpose());
  return made;
}

/// sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 of uniform inputs from -pi to pi \cite ishigami1990.
inline double ishigami(const VectorX& x) {
  return std::sin(x[0]) + 7.0 * std::pow(std::sin(x[1]), 2) +
         0.1 * std::pow(x[2], 4) * std::sin(x[0]);
}
inline std::vector<Distribution> ishigami_inputs() {
  return std::vector<Distribution>(3, uniform(-std::numbers::pi, std::numbers::pi));
}

inline const std::vector<std::vector<Index>> kThreeInputs{{0}, {1}, {2}};

}  // namespace lefort::uncertainty
