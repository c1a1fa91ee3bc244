#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/field/sign/outside_band.h>
#include <lefort/field/sign/resolve_sign_conflicts.h>
#include <lefort/field/storage/dense_samples.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lefort::field {

namespace {

/// Calls body(first, x, y, z, count) for the rows of a brick that lie in the cube: `first` is the
/// offset of the row in the brick; x, y, z is its lattice point, `count` its length.
template <class Body>
void for_each_row(std::int32_t brick, int resolution, const Body& body) {
  const LatticePoint low = SparseLattice::first_point_of(brick, resolution);
  if (low[0] < 0 || low[0] > resolution) return;
  const int count = std::min(kBrickSide, resolution + 1 - low[0]);
  for (int z = 0; z < kBrickSide; ++z)
    for (int y = 0; y < kBrickSide; ++y) {
      const int ly = low[1] + y, lz = low[2] + z;
      if (ly < 0 || lz < 0 || ly > resolution || lz > resolution) continue;
      body(std::size_t((z * kBrickSide + y) * kBrickSide), low[0], ly, lz, std::size_t(count));
    }
}

}  // namespace

DenseSamples::DenseSamples(int resolution, std::vector<float> values)
    : resolution_(resolution), values_(std::move(values)) {
  const auto n = std::size_t(resolution) + 1;
  LEFORT_CHECK(values_.size() == n * n * n);
}

CellSamples DenseSamples::cell(const LatticePoint& low) const {
  CellSamples samples{low, 1, {}};
  const auto n = std::size_t(resolution_) + 1;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t x = std::size_t(low[0]) + (corner & 1),
                      y = std::size_t(low[1]) + (corner >> 1 & 1),
                      z = std::size_t(low[2]) + (corner >> 2);
    samples.corners[corner] = values_[(z * n + y) * n + x];
  }
  return samples;
}

Result<DenseSamples> build_dense(const BandSampler& sampler, const FieldFrame& frame,
                                 const WindingScanlines* winding, Progress& progress) {
  const auto n = std::size_t(frame.resolution) + 1;
  std::vector<float> values(n * n * n);
  const auto offset = [&](int x, int y, int z) {
    return std::ptrdiff_t((std::size_t(z) * n + std::size_t(y)) * n + std::size_t(x));
  };
  const std::span<const std::int32_t> candidates = sampler.bricks();
  const auto side = Index(SparseLattice::bricks_per_side(frame.resolution));
  std::vector<std::int32_t> slots(std::size_t(side * side * side), SparseLattice::kNoBrick);
  for (std::size_t slot = 0; slot < candidates.size(); ++slot)
    slots[std::size_t(candidates[slot])] = std::int32_t(slot);

  const auto fill_brick = [&](Index b) {
    const auto brick = std::int32_t(b);
    std::array<float, SparseLattice::kBrickPoints> distances;
    const std::int32_t slot = slots[std::size_t(b)];
    BrickSigns signs;
    if (slot != SparseLattice::kNoBrick) signs = sampler.sample(slot, distances);
    const bool any = signs.any_known();
    if (any && winding != nullptr) {
      resolve_sign_conflicts(distances, signs, inside_with_unsampled(signs, *winding, brick, frame),
                             winding, brick, frame);
      fill_points_outside_band(distances, *winding, brick, frame);
    }
    if (!any)
      distances.fill(zone_value(winding == nullptr
                                    ? Zone::kUnknown
                                    : zone_of_empty_brick(*winding, brick, frame.resolution)));
    for_each_row(brick, frame.resolution,
                 [&](std::size_t first, int x, int y, int z, std::size_t length) {
                   std::copy_n(distances.begin() + std::ptrdiff_t(first), length,
                               values.begin() + offset(x, y, z));
                 });
  };
  for (Index slice = 0; slice < side; ++slice) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");
    parallel_for(
        side * side, [&](Index b) { fill_brick(slice * side * side + b); }, 8);
    progress.report(double(slice + 1) / double(side));
  }
  return DenseSamples(frame.resolution, std::move(values));
}

}  // namespace lefort::field
