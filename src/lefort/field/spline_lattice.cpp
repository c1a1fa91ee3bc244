#include <lefort/core/parallel.h>
#include <lefort/field/spline_lattice.h>
#include <lefort/field/tear.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::field {

namespace {

constexpr int kSide = SparseLattice::kSide;
constexpr float kNoCoefficient = std::numeric_limits<float>::quiet_NaN();

float coefficient_at(const SparseLattice& values, const LatticePoint& point, double cell) {
  const int last = values.resolution() + 2 * kSide - 1;
  const float here = values.at(point, kNoCoefficient);
  if (std::isnan(here)) return kNoCoefficient;
  double differences = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int step : {-1, 1}) {
      LatticePoint neighbour = point;
      neighbour[axis] += step;
      if (neighbour[axis] < -kSide || neighbour[axis] > last) return kNoCoefficient;
      const float there = values.at(neighbour, kNoCoefficient);
      if (std::isnan(there) || is_torn(here, there, float(cell))) return kNoCoefficient;
      differences += double(there) - double(here);
    }
  }
  return float(double(here) - differences / 6.0);
}

}  // namespace

SparseLattice spline_coefficients(const SparseLattice& values, double cell, double reach) {
  std::vector<std::int32_t> bricks;
  for (Index slot = 0; slot < values.brick_count(); ++slot) {
    const auto brick = values.brick(slot);
    const auto is_near = [&](float value) { return std::abs(value) <= reach; };
    if (std::any_of(brick.begin(), brick.end(), is_near))
      bricks.push_back(values.brick_number(slot));
  }
  SparseLattice coefficients(values.resolution(), std::move(bricks), kNoCoefficient);
  const auto fill_brick = [&](Index slot) {
    const LatticePoint first = coefficients.first_point(coefficients.brick_number(slot));
    const auto brick = coefficients.brick(slot);
    for (int i = 0; i < SparseLattice::kBrickPoints; ++i) {
      const LatticePoint point = {first[0] + i % kSide, first[1] + i / kSide % kSide,
                                  first[2] + i / (kSide * kSide)};
      brick[std::size_t(i)] = coefficient_at(values, point, cell);
    }
  };
  parallel_for(coefficients.brick_count(), fill_brick, 8);
  return coefficients;
}

}  // namespace lefort::field
