#include <lefort/core/parallel.h>
#include <lefort/core/trace.h>
#include <lefort/field/sign/violates_lipschitz.h>
#include <lefort/field/storage/spline_lattice.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::field {

namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

float value_without_conflict(const SparseLattice& values, const LatticePoint& point, double cell) {
  const int last = values.resolution() + 2 * kBrickSide - 1;
  const float here = values.at(point, kNoValue);
  if (std::isnan(here)) return kNoValue;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int step : {-1, 1}) {
      LatticePoint neighbor = point;
      neighbor[axis] += step;
      if (neighbor[axis] < -kBrickSide || neighbor[axis] > last) continue;
      if (violates_lipschitz(here, values.at(neighbor, kNoValue), float(cell))) return kNoValue;
    }
  }
  return here;
}

}  // namespace

SparseLattice spline_lattice(const SparseLattice& values, double cell, double max_magnitude) {
  const TraceSpan span("spline of the field");
  std::vector<std::int32_t> bricks;
  for (Index slot = 0; slot < values.brick_count(); ++slot) {
    const auto brick = values.brick(slot);
    const auto is_kept = [&](float value) { return std::abs(value) <= max_magnitude; };
    if (std::any_of(brick.begin(), brick.end(), is_kept))
      bricks.push_back(values.brick_number(slot));
  }
  SparseLattice kept(values.resolution(), std::move(bricks), kNoValue);
  const auto fill_brick = [&](Index slot) {
    const LatticePoint first = kept.first_point(kept.brick_number(slot));
    const auto brick = kept.brick(slot);
    for (int i = 0; i < SparseLattice::kBrickPoints; ++i) {
      const LatticePoint point = {first[0] + i % kBrickSide, first[1] + i / kBrickSide % kBrickSide,
                                  first[2] + i / (kBrickSide * kBrickSide)};
      brick[std::size_t(i)] = value_without_conflict(values, point, cell);
    }
  };
  parallel_for(kept.brick_count(), fill_brick, 8);
  return kept;
}

}  // namespace lefort::field
