#include <lefort/core/check.h>
#include <lefort/field/query_bricks.h>
#include <lefort/field/trilinear.h>

#include <algorithm>
#include <array>

namespace lefort::field {

namespace {

/// Points worked on together: enough for memory to arrive, few enough to stay in the first cache.
constexpr std::size_t kGroup = 32;

/// A point on its way through the three stages.
struct Pending {
  LatticePoint cell;
  std::array<double, 3> t;  ///< Position in the cell.
  bool in_box;
  std::array<const std::byte*, 8> corners;
};

void prefetch(const void* place) { __builtin_prefetch(place); }

/// What a lookup needs again and again.
struct Lookup {
  const Brick* bricks;
  const std::byte* codes;
  std::int32_t side;  ///< Bricks along a side of the table.
  std::array<double, 3> origin;
  double cells_per_mm;
  int resolution;

  Lookup(const BrickSamples& samples, const FieldFrame& frame)
      : bricks(samples.bricks().data()),
        codes(samples.codes().data()),
        side(SparseLattice::bricks_per_side(samples.resolution())),
        origin{frame.origin_B[0], frame.origin_B[1], frame.origin_B[2]},
        cells_per_mm(1.0 / frame.cell_mm),
        resolution(frame.resolution) {}
};

/// Stage 1: which cell.
Pending locate(const Lookup& lookup, const Vec3& p_B) {
  Pending pending;
  const std::array<double, 3> u = {(p_B[0] - lookup.origin[0]) * lookup.cells_per_mm,
                                   (p_B[1] - lookup.origin[1]) * lookup.cells_per_mm,
                                   (p_B[2] - lookup.origin[2]) * lookup.cells_per_mm};
  const double most = lookup.resolution;
  // NaN fails, too.
  pending.in_box =
      u[0] >= 0.0 && u[1] >= 0.0 && u[2] >= 0.0 && u[0] <= most && u[1] <= most && u[2] <= most;
  if (!pending.in_box) return pending;
  for (std::size_t k = 0; k < 3; ++k) {
    pending.cell[k] = std::min(int(u[k]), lookup.resolution - 1);
    pending.t[k] = u[k] - pending.cell[k];
  }
  const LatticePoint& c = pending.cell;
  prefetch(lookup.bricks + ((c[2] / 8 + 1) * lookup.side + c[1] / 8 + 1) * lookup.side + c[0] / 8 +
           1);
  return pending;
}

/// Where a coordinate lies: its share of the number of a brick, of a leaf, and of a place in it.
struct AxisPlace {
  std::int32_t brick;
  std::uint32_t leaf;
  std::uint32_t offset;

  AxisPlace(int coordinate, std::int32_t brick_stride, unsigned axis) {
    const auto c = std::uint32_t(coordinate);
    brick = std::int32_t(c / 8U + 1U) * brick_stride;
    leaf = (c >> 2 & 1U) << axis;
    offset = (c & 3U) * (std::uint32_t(BrickSamples::kCodeBytes) << (2U * axis));
  }
};

/// Stage 2: where its samples are. Seven cells in twelve have them in more than one leaf.
void find_corners(const BrickSamples& samples, const Lookup& lookup, Pending& pending) {
  static_assert(SparseLattice::kSide == 8 && BrickSamples::kLeafSide == 4);
  const LatticePoint& c = pending.cell;
  const std::int32_t row = lookup.side, slice = lookup.side * lookup.side;
  const AxisPlace x(c[0], 1, 0), y(c[1], row, 1), z(c[2], slice, 2);
  const auto place = [&](const AxisPlace& i, const AxisPlace& j, const AxisPlace& k,
                         int corner) -> const std::byte* {
    const Brick& brick = lookup.bricks[i.brick + j.brick + k.brick];
    const std::uint32_t leaf = i.leaf | j.leaf | k.leaf;
    if ((brick.stored >> leaf & 1U) == 0) [[unlikely]]
      return samples.place_of(
          {c[0] + (corner & 1), c[1] + (corner >> 1 & 1), c[2] + (corner >> 2)});
    return lookup.codes + BrickSamples::position_of(brick, leaf) * BrickSamples::kLeafBytes +
           (i.offset + j.offset + k.offset);
  };

  if (((c[0] & 3) != 3) & ((c[1] & 3) != 3) & ((c[2] & 3) != 3)) {
    const std::byte* const first = place(x, y, z, 0);
    const bool stored =
        (lookup.bricks[x.brick + y.brick + z.brick].stored >> (x.leaf | y.leaf | z.leaf) & 1U) != 0;
    constexpr std::size_t kX = BrickSamples::kCodeBytes, kY = kX * BrickSamples::kLeafSide,
                          kZ = kY * BrickSamples::kLeafSide;
    constexpr std::array<std::size_t, 8> kOffsets = {0,  kX,      kY,      kY + kX,
                                                     kZ, kZ + kX, kZ + kY, kZ + kY + kX};
    for (std::size_t corner = 0; corner < 8; ++corner)
      pending.corners[corner] = first + (stored ? kOffsets[corner] : 0);
    prefetch(pending.corners[0]);
    prefetch(pending.corners[7]);
    return;
  }
  const AxisPlace next_x(c[0] + 1, 1, 0), next_y(c[1] + 1, row, 1), next_z(c[2] + 1, slice, 2);
  pending.corners = {place(x, y, z, 0),           place(next_x, y, z, 1),
                     place(x, next_y, z, 2),      place(next_x, next_y, z, 3),
                     place(x, y, next_z, 4),      place(next_x, y, next_z, 5),
                     place(x, next_y, next_z, 6), place(next_x, next_y, next_z, 7)};
  for (const std::byte* corner : pending.corners) prefetch(corner);
}

/// Stage 3: the samples, in units of the quantum. False if one of them is no distance.
template <class Real>
bool read_corners(const Pending& pending, std::array<Real, 8>& corners) {
  bool all_known = true;
  for (std::size_t i = 0; i < 8; ++i) {
    const std::int32_t code = BrickSamples::read_code(pending.corners[i]);
    all_known &= BrickSamples::is_distance(code);
    corners[i] = Real(code);
  }
  return all_known;
}

/// Where a point is that lies between samples of which one is no distance.
Zone zone_at(const BrickSamples& samples, const Pending& pending) {
  std::array<float, 8> corners;
  for (std::size_t i = 0; i < 8; ++i)
    corners[i] = samples.distance_of(BrickSamples::read_code(pending.corners[i]));
  return zone_of(corners);
}

/// Calls finish(i, pending) for all points, in groups.
template <class Finish>
void for_each_point(const BrickSamples& samples, const FieldFrame& frame, std::span<const Vec3> p_B,
                    const Finish& finish) {
  const Lookup lookup(samples, frame);
  std::array<Pending, kGroup> group;
  for (std::size_t begin = 0; begin < p_B.size(); begin += kGroup) {
    const std::size_t count = std::min(kGroup, p_B.size() - begin);
    for (std::size_t i = 0; i < count; ++i) group[i] = locate(lookup, p_B[begin + i]);
    for (std::size_t i = 0; i < count; ++i)
      if (group[i].in_box) find_corners(samples, lookup, group[i]);
    for (std::size_t i = 0; i < count; ++i) finish(begin + i, group[i]);
  }
}

}  // namespace

void sample_bricks(const BrickSamples& samples, const FieldFrame& frame, std::span<const Vec3> p_B,
                   std::span<FieldSample> results) {
  LEFORT_CHECK(p_B.size() == results.size());
  // In double precision: solvers take differences of these.
  const double quantum_mm = double(samples.quantum_mm());
  const double slope = quantum_mm / frame.cell_mm;
  for_each_point(samples, frame, p_B, [&](std::size_t i, const Pending& pending) {
    std::array<double, 8> corners;
    if (!pending.in_box) [[unlikely]] {
      results[i] = beyond_band(zone_beyond_box(frame, p_B[i]), frame.band_mm);
    } else if (!read_corners(pending, corners)) [[unlikely]] {
      results[i] = beyond_band(zone_at(samples, pending), frame.band_mm);
    } else {
      const std::array<double, 3> gradient = trilinear_gradient(corners, pending.t);
      results[i] = {Zone::kBand, trilinear(corners, pending.t) * quantum_mm,
                    Vec3(gradient[0] * slope, gradient[1] * slope, gradient[2] * slope)};
    }
  });
}

void distances_in_bricks(const BrickSamples& samples, const FieldFrame& frame,
                         std::span<const Vec3> p_B, std::span<float> distances_mm) {
  LEFORT_CHECK(p_B.size() == distances_mm.size());
  for_each_point(samples, frame, p_B, [&](std::size_t i, const Pending& pending) {
    std::array<float, 8> corners;
    if (!pending.in_box) [[unlikely]] {
      distances_mm[i] = side_value(zone_beyond_box(frame, p_B[i]));
    } else if (!read_corners(pending, corners)) [[unlikely]] {
      distances_mm[i] = side_value(zone_at(samples, pending));
    } else {
      const std::array<float, 3> t = {float(pending.t[0]), float(pending.t[1]),
                                      float(pending.t[2])};
      distances_mm[i] = trilinear(corners, t) * samples.quantum_mm();
    }
  });
}

}  // namespace lefort::field
