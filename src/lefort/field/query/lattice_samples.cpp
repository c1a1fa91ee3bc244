#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/field/query/lattice_samples.h>
#include <lefort/field/query/trilinear.h>
#include <lefort/field/sign/violates_lipschitz.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lefort::field {

namespace {

constexpr float kNoDistance = std::numeric_limits<float>::quiet_NaN();
/// Blocks that are read before they are passed on.
constexpr Index kWave = 4096;

/// Samples of a block and one layer around it, for the detection of sign conflicts.
class BlockNeighborhood {
 public:
  static constexpr int kAcross = kBrickSide + 2;

  template <class SampleAt>
  BlockNeighborhood(const LatticePoint& first, int resolution, const SampleAt& sample_at) {
    for (int z = -1; z <= kBrickSide; ++z)
      for (int y = -1; y <= kBrickSide; ++y)
        for (int x = -1; x <= kBrickSide; ++x) {
          const LatticePoint p = {first[0] + x, first[1] + y, first[2] + z};
          const bool in_lattice =
              std::all_of(p.begin(), p.end(), [&](int c) { return c >= 0 && c <= resolution; });
          values_[offset(x, y, z)] = in_lattice ? sample_at(p) : kNoDistance;
        }
  }

  /// Copies the block, without samples that are in conflict with a neighbor.
  ///
  /// \param slack_mm  possible error of each sample.
  void copy_to(SampleBlock& block, double cell_mm, double slack_mm) const {
    const auto max_mm = float(cell_mm * double(kMaxSlope) + 2.0 * slack_mm);
    constexpr std::array<std::size_t, 3> kStride = {1, kAcross, kAcross * kAcross};
    for (int z = 0; z < kBrickSide; ++z)
      for (int y = 0; y < kBrickSide; ++y)
        for (int x = 0; x < kBrickSide; ++x) {
          const std::size_t here = offset(x, y, z);
          bool in_conflict = false;
          if (std::isfinite(values_[here]))
            for (const std::size_t stride : kStride)
              for (const std::size_t next : {here - stride, here + stride})
                in_conflict = in_conflict || (std::isfinite(values_[next]) &&
                                              std::abs(values_[here] - values_[next]) > max_mm);
          block.values[std::size_t((z * kBrickSide + y) * kBrickSide + x)] =
              in_conflict ? kNoDistance : values_[here];
        }
  }

 private:
  static std::size_t offset(int x, int y, int z) {
    return std::size_t(((z + 1) * kAcross + y + 1) * kAcross + x + 1);
  }

  std::array<float, std::size_t(kAcross) * kAcross * kAcross> values_;
};

// Bricks

void read_bricks(const BrickSamples& samples, const FieldFrame&, SampleBlock& block) {
  const Brick& brick = samples.bricks()[std::size_t(samples.brick_of(block.first))];
  if (brick.stored == 0) {
    // Same precedence as in BrickSamples::code_address(): unknown before inside.
    if (brick.unknown == 0xFF) block.zone = Zone::kUnknown;
    if (brick.unknown == 0 && brick.inside == 0xFF) block.zone = Zone::kInside;
    if (brick.unknown == 0 && brick.inside == 0) block.zone = Zone::kOutside;
    if (block.zone) return;
  }
  for (int offset = 0; offset < SparseLattice::kBrickPoints; ++offset) {
    const LatticePoint p = {block.first[0] + offset % kBrickSide,
                            block.first[1] + offset / kBrickSide % kBrickSide,
                            block.first[2] + offset / (kBrickSide * kBrickSide)};
    block.values[std::size_t(offset)] =
        samples.distance_of(BrickSamples::read_code(samples.code_address(p)));
  }
}

// Dense samples

void read_dense(const DenseSamples& samples, const FieldFrame& frame, SampleBlock& block) {
  const auto n = std::size_t(frame.resolution) + 1;
  const auto sample_at = [&](const LatticePoint& p) {
    return samples.values()[(std::size_t(p[2]) * n + std::size_t(p[1])) * n + std::size_t(p[0])];
  };
  BlockNeighborhood(block.first, frame.resolution, sample_at).copy_to(block, frame.cell_mm, 0.0);
}

// Octrees

bool contains(const CellSamples& leaf, const LatticePoint& cell) {
  for (std::size_t k = 0; k < 3; ++k)
    if (cell[k] < leaf.low[k] || cell[k] >= leaf.low[k] + leaf.cells) return false;
  return true;
}

/// The leaves at the points of a block and its neighbors.
class Leaves {
 public:
  static constexpr int kAcross = kBrickSide + 3;

  Leaves(const Octree& octree, const LatticePoint& first) : low_(first) {
    for (int& c : low_) c -= 2;
    leaves_.reserve(std::size_t(kAcross) * kAcross * kAcross);
    for (int z = 0; z < kAcross; ++z)
      for (int y = 0; y < kAcross; ++y)
        for (int x = 0; x < kAcross; ++x) {
          const LatticePoint cell = {low_[0] + x, low_[1] + y, low_[2] + z};
          const bool in_tree = std::all_of(
              cell.begin(), cell.end(), [&](int c) { return c >= 0 && c < octree.resolution(); });
          if (!in_tree) {
            leaves_.push_back({cell, 0, {}});
          } else if (!leaves_.empty() && contains(leaves_.back(), cell)) {
            leaves_.push_back(CellSamples(leaves_.back()));
          } else {
            leaves_.push_back(octree.cell(cell));
          }
        }
  }

  /// The sample at a point, from the smallest leaf around it that has one.
  [[nodiscard]] float at(const LatticePoint& point) const {
    const CellSamples* smallest = nullptr;
    bool outside = false, inside = false, unknown = false;
    for (int corner = 0; corner < 8; ++corner) {
      const CellSamples& leaf = leaf_at(point, corner);
      if (leaf.cells == 0) continue;
      switch (zone_of(leaf.corners)) {
        case Zone::kBand:
          if (smallest == nullptr || leaf.cells < smallest->cells) smallest = &leaf;
          break;
        case Zone::kOutside:
          outside = true;
          break;
        case Zone::kInside:
          inside = true;
          break;
        case Zone::kUnknown:
          unknown = true;
      }
    }
    if (smallest != nullptr) return interpolate(*smallest, point);
    if (unknown || inside == outside) return kNoDistance;
    return zone_value(inside ? Zone::kInside : Zone::kOutside);
  }

 private:
  /// The leaf of one of the eight cells at a point.
  [[nodiscard]] const CellSamples& leaf_at(const LatticePoint& point, int corner) const {
    const int x = point[0] - low_[0] - (corner & 1), y = point[1] - low_[1] - (corner >> 1 & 1),
              z = point[2] - low_[2] - (corner >> 2);
    return leaves_[std::size_t((z * kAcross + y) * kAcross + x)];
  }

  static float interpolate(const CellSamples& leaf, const LatticePoint& point) {
    std::array<double, 8> corners{};
    std::copy(leaf.corners.begin(), leaf.corners.end(), corners.begin());
    std::array<double, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) t[k] = double(point[k] - leaf.low[k]) / leaf.cells;
    return float(trilinear(corners, t));
  }

  LatticePoint low_;
  std::vector<CellSamples> leaves_;  ///< With no cells outside the lattice.
};

/// The common zone of all points of a block, if leaves of at least its size determine it.
std::optional<Zone> zone_of_large_leaves(const Octree& octree, const LatticePoint& first) {
  std::optional<Zone> side;
  for (int corner = 0; corner < 8; ++corner) {
    const LatticePoint cell = {first[0] - (corner & 1), first[1] - (corner >> 1 & 1),
                               first[2] - (corner >> 2)};
    const bool in_tree = std::all_of(cell.begin(), cell.end(),
                                     [&](int c) { return c >= 0 && c < octree.resolution(); });
    if (!in_tree) continue;
    const CellSamples leaf = octree.cell(cell);
    const Zone zone = zone_of(leaf.corners);
    if (leaf.cells < kBrickSide || zone == Zone::kBand || (side && *side != zone))
      return std::nullopt;
    side = zone;
  }
  return side;
}

void read_octree(const Octree& octree, const FieldFrame& frame, SampleBlock& block) {
  block.zone = zone_of_large_leaves(octree, block.first);
  if (block.zone) return;
  const Leaves leaves(octree, block.first);
  BlockNeighborhood(block.first, frame.resolution, [&](const LatticePoint& p) {
    return leaves.at(p);
  }).copy_to(block, frame.cell_mm, frame.tolerance_mm);
}

/// Blocks of the lattice that overlap a window, along an axis.
struct BlockRange {
  int first, count;
};
BlockRange blocks_along(const LatticeWindow& window, std::size_t axis) {
  const int first = window.first[axis] / kBrickSide;
  const int last = (window.first[axis] + (window.count[axis] - 1) * window.every) / kBrickSide;
  return {first, last - first + 1};
}

}  // namespace

void read_block(const DistanceField& field, const LatticePoint& first, SampleBlock& block) {
  const FieldFrame& frame = field.frame();
  for (const int c : first) LEFORT_CHECK(c >= 0 && c <= frame.resolution && c % kBrickSide == 0);
  block.first = first;
  block.zone.reset();
  if (const auto* bricks = std::get_if<BrickSamples>(&field.samples())) {
    read_bricks(*bricks, frame, block);
  } else if (const auto* octree = std::get_if<Octree>(&field.samples())) {
    read_octree(*octree, frame, block);
  } else {
    read_dense(std::get<DenseSamples>(field.samples()), frame, block);
  }
}

std::optional<LatticePoint> LatticeWindow::find(const LatticePoint& point) const {
  LatticePoint position{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int from_first = point[k] - first[k];
    position[k] = from_first / every;
    if (from_first < 0 || from_first % every != 0 || position[k] >= count[k]) return std::nullopt;
  }
  return position;
}

Result<LatticeWindow> window_of(const FieldFrame& frame, const std::optional<Box3>& region_B,
                                int every) {
  if (every < 1 || every > frame.resolution)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("every is {}, it must be from 1 to the resolution of the field, {}",
                            every, frame.resolution));
  if (region_B && (region_B->min().array().isNaN().any() || region_B->max().array().isNaN().any()))
    return fail(ErrorCode::kInvalidArgument,
                "region has a limit that is not a number, it must have six numbers");
  LatticeWindow window;
  window.every = every;
  for (int k = 0; k < 3; ++k) {
    double low = 0.0, high = frame.resolution;
    if (region_B) {
      // Limits that coincide with samples include them, despite rounding.
      constexpr double kSlack = 1e-9;
      low = std::max(low, (region_B->min()[k] - frame.origin_B[k]) / frame.cell_mm - kSlack);
      high = std::min(high, (region_B->max()[k] - frame.origin_B[k]) / frame.cell_mm + kSlack);
    }
    const double first = std::ceil(low / every), last = std::floor(high / every);
    if (!(first <= last))
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("region runs from {} to {} mm along {}, it must contain samples of the "
                      "field, which lie from {:.6g} to {:.6g} mm, {:.6g} mm apart",
                      region_B ? region_B->min()[k] : 0.0, region_B ? region_B->max()[k] : 0.0,
                      "xyz"[k], frame.origin_B[k],
                      frame.origin_B[k] + frame.resolution * frame.cell_mm, every * frame.cell_mm));
    window.first[std::size_t(k)] = int(first) * every;
    window.count[std::size_t(k)] = int(last - first) + 1;
  }
  return window;
}

Result<void> for_each_block(const DistanceField& field, const LatticeWindow& window,
                            Progress& progress,
                            const std::function<void(const SampleBlock&)>& body) {
  const BlockRange x = blocks_along(window, 0), y = blocks_along(window, 1),
                   z = blocks_along(window, 2);
  const Index total = Index(x.count) * y.count * z.count;
  std::vector<SampleBlock> wave(std::size_t(std::min(kWave, total)));
  for (Index begin = 0; begin < total; begin += kWave) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "the samples of the field were not all read");
    const Index count = std::min(kWave, total - begin);
    parallel_for(
        count,
        [&](Index i) {
          const Index b = begin + i;
          const LatticePoint first = {kBrickSide * (x.first + int(b % x.count)),
                                      kBrickSide * (y.first + int(b / x.count % y.count)),
                                      kBrickSide * (z.first + int(b / x.count / y.count))};
          read_block(field, first, wave[std::size_t(i)]);
        },
        16);
    for (Index i = 0; i < count; ++i) body(wave[std::size_t(i)]);
    progress.report(double(begin + count) / double(total));
  }
  return {};
}

void SampleCount::add(float sample, Index times) {
  if (std::isfinite(sample)) known += times;
  if (std::isnan(sample)) unknown += times;
  if (std::isinf(sample)) (sample > 0.0F ? outside : inside) += times;
}

Result<SampleCount> count_samples(const DistanceField& field, Progress& progress) {
  const int resolution = field.frame().resolution;
  LEFORT_TRY(const LatticeWindow all, window_of(field.frame(), std::nullopt, 1));
  SampleCount count;
  LEFORT_TRY_VOID(for_each_block(field, all, progress, [&](const SampleBlock& block) {
    LatticePoint size{};
    for (std::size_t k = 0; k < 3; ++k)
      size[k] = std::min(kBrickSide, resolution + 1 - block.first[k]);
    if (block.zone) return count.add(zone_value(*block.zone), Index(size[0]) * size[1] * size[2]);
    for (int z = 0; z < size[2]; ++z)
      for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x)
          count.add(block.values[std::size_t((z * kBrickSide + y) * kBrickSide + x)]);
  }));
  return count;
}

}  // namespace lefort::field
