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

/// The four cubic B-splines that do not vanish at 0 <= t <= 1, and their derivatives.
struct Weights {
  std::array<double, 4> value, slope, curvature;
};

Weights weights_at(double t) {
  const double s = 1.0 - t;
  return {{s * s * s / 6.0, (4.0 - 3.0 * t * t * (2.0 - t)) / 6.0,
           (4.0 - 3.0 * s * s * (2.0 - s)) / 6.0, t * t * t / 6.0},
          {-0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), -0.5 * s * (3.0 * s - 4.0), 0.5 * t * t},
          {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t}};
}

/// 4 x 4 x 4 coefficients around a cell, x fastest. They lie in at most eight bricks.
std::array<double, 64> gather(const SparseLattice& coefficients, const LatticePoint& cell) {
  std::array<double, 64> gathered{};
  const LatticePoint low = {cell[0] - 1, cell[1] - 1, cell[2] - 1};
  std::array<int, 3> split{};  // How many of the four lie in the first brick, by axis.
  for (std::size_t k = 0; k < 3; ++k) split[k] = std::min(4, kSide - (low[k] + kSide) % kSide);

  for (int half = 0; half < 8; ++half) {
    std::array<int, 3> begin{}, end{};
    LatticePoint first{};
    for (std::size_t k = 0; k < 3; ++k) {
      const bool upper = (half >> k & 1) != 0;
      begin[k] = upper ? split[k] : 0;
      end[k] = upper ? 4 : split[k];
      first[k] = low[k] + begin[k];
    }
    if (begin[0] == end[0] || begin[1] == end[1] || begin[2] == end[2]) continue;
    const std::int32_t slot = coefficients.slot_of(coefficients.brick_of(first));
    const auto place = std::size_t(SparseLattice::place_of(first));
    for (int c = begin[2]; c < end[2]; ++c)
      for (int b = begin[1]; b < end[1]; ++b)
        for (int a = begin[0]; a < end[0]; ++a) {
          const auto step =
              std::size_t(((c - begin[2]) * kSide + (b - begin[1])) * kSide + (a - begin[0]));
          gathered[std::size_t((c * 4 + b) * 4 + a)] =
              slot == SparseLattice::kNoBrick ? double(kNoCoefficient)
                                              : double(coefficients.brick(slot)[place + step]);
        }
  }
  return gathered;
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

SplineValue evaluate_spline(const SparseLattice& coefficients, const Vec3& u) {
  LatticePoint cell{};
  std::array<Weights, 3> w{};
  for (int k = 0; k < 3; ++k) {
    const int last = coefficients.resolution() - 1;
    const int low = std::clamp(int(std::floor(u[k])), 0, last);
    cell[std::size_t(k)] = low;
    w[std::size_t(k)] = weights_at(u[k] - low);
  }
  const std::array<double, 64> c = gather(coefficients, cell);

  SplineValue sum{0.0, Vec3::Zero(), Mat3::Zero()};
  for (std::size_t z = 0; z < 4; ++z) {
    for (std::size_t y = 0; y < 4; ++y) {
      double value = 0.0, slope = 0.0, curvature = 0.0;  // Along x, through this row.
      for (std::size_t x = 0; x < 4; ++x) {
        const double at = c[(z * 4 + y) * 4 + x];
        value += w[0].value[x] * at;
        slope += w[0].slope[x] * at;
        curvature += w[0].curvature[x] * at;
      }
      const double vv = w[1].value[y] * w[2].value[z];
      const double sv = w[1].slope[y] * w[2].value[z];
      const double vs = w[1].value[y] * w[2].slope[z];
      sum.value += vv * value;
      sum.gradient += Vec3(vv * slope, sv * value, vs * value);
      sum.hessian(0, 0) += vv * curvature;
      sum.hessian(1, 1) += w[1].curvature[y] * w[2].value[z] * value;
      sum.hessian(2, 2) += w[1].value[y] * w[2].curvature[z] * value;
      sum.hessian(0, 1) += sv * slope;
      sum.hessian(0, 2) += vs * slope;
      sum.hessian(1, 2) += w[1].slope[y] * w[2].slope[z] * value;
    }
  }
  sum.hessian(1, 0) = sum.hessian(0, 1);
  sum.hessian(2, 0) = sum.hessian(0, 2);
  sum.hessian(2, 1) = sum.hessian(1, 2);
  return sum;
}

}  // namespace lefort::field
