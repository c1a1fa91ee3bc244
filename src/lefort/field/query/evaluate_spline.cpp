#include <lefort/core/check.h>
#include <lefort/field/internal/simd.h>
#include <lefort/field/query/evaluate_spline.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

// The tensor product is summed axis by axis, with one row of four values along x per vector: 16
// rows, first along z, then along y; ten sums of four values remain.

namespace lefort::field {

namespace {

constexpr std::size_t kRow = 4;  ///< Values per cell along an axis.
/// Points whose values are prefetched together.
constexpr std::size_t kGroup = 16;

using Row = double __attribute__((vector_size(kRow * sizeof(double))));
using StoredRow = float __attribute__((vector_size(kRow * sizeof(float))));

/// Replaces bricks that do not exist.
constexpr auto kAbsent = [] {
  std::array<float, SparseLattice::kBrickPoints> brick{};
  brick.fill(std::numeric_limits<float>::quiet_NaN());
  return brick;
}();

/// Weights of the values at -1, 0, 1 and 2 for the spline at 0 <= t <= 1 and for its derivatives.
struct Weights {
  std::array<double, kRow> value, slope, curvature;
};

LEFORT_INLINE Weights weights_at(double t) {
  const double s = 1.0 - t;
  return {{-0.5 * t * s * s, 1.0 + t * t * (1.5 * t - 2.5), 1.0 + s * s * (1.5 * s - 2.5),
           -0.5 * s * t * t},
          {0.5 * s * (3.0 * t - 1.0), t * (4.5 * t - 5.0), -s * (4.5 * s - 5.0),
           -0.5 * t * (3.0 * s - 1.0)},
          {2.0 - 3.0 * t, 9.0 * t - 5.0, 9.0 * s - 5.0, 2.0 - 3.0 * s}};
}

/// Location of the 4 x 4 x 4 values around a point: they begin at `first` in the first of at most
/// eight bricks.
struct Neighborhood {
  std::array<const float*, 8> bricks;  ///< x fastest.
  std::array<int, 3> first;
  std::array<double, 3> t;  ///< Position of the point in its cell.
};

/// True if the rows extend into another brick.
LEFORT_INLINE bool is_split(const Neighborhood& neighborhood) {
  return neighborhood.first[0] + int(kRow) > kBrickSide;
}

LEFORT_INLINE const float* row_at(const Neighborhood& neighborhood, int y, int z, int x_brick) {
  const int brick = x_brick | (y / kBrickSide) << 1 | (z / kBrickSide) << 2;
  return neighborhood.bricks[std::size_t(brick)] +
         ((z % kBrickSide) * kBrickSide + y % kBrickSide) * kBrickSide;
}

LEFORT_INLINE void locate(const SparseLattice& lattice, const Vec3& u, Neighborhood& neighborhood) {
  const int n = lattice.bricks_per_side(), last = lattice.resolution() - 1;
  LatticePoint low{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double at = u[Index(k)];
    const int cell = int(std::clamp(at, 0.0, double(last)));
    neighborhood.t[k] = at - cell;
    low[k] = cell - 1;
    neighborhood.first[k] = (low[k] + kBrickSide) % kBrickSide;
  }
  const std::int32_t brick = lattice.brick_of(low);
  for (int i = 0; i < 8; ++i) {
    const std::int32_t slot =
        lattice.slot_of(brick + (i & 1) + (i >> 1 & 1) * n + (i >> 2) * n * n);
    neighborhood.bricks[std::size_t(i)] =
        slot == SparseLattice::kNoBrick ? kAbsent.data() : lattice.brick(slot).data();
  }
  // Four rows of a brick have 128 bytes, which lie in three cache lines for any alignment.
  const int y = neighborhood.first[1];
  for (int z = neighborhood.first[2]; z < neighborhood.first[2] + int(kRow); ++z)
    for (int x = 0; x <= int(is_split(neighborhood)); ++x) {
      __builtin_prefetch(row_at(neighborhood, y, z, x));
      __builtin_prefetch(row_at(neighborhood, y + 2, z, x));
      __builtin_prefetch(row_at(neighborhood, y + 3, z, x) + kBrickSide - 1);
    }
}

LEFORT_INLINE StoredRow load(const float* from) {
  StoredRow row;
  std::memcpy(&row, from, sizeof(row));
  return row;
}

/// 4 x 4 rows, y fastest.
LEFORT_INLINE void read_rows(const Neighborhood& neighborhood, std::array<Row, kRow * kRow>& rows) {
  const int x = neighborhood.first[0];
  if (!is_split(neighborhood)) {
    for (std::size_t i = 0; i < rows.size(); ++i)
      rows[i] =
          __builtin_convertvector(load(row_at(neighborhood, neighborhood.first[1] + int(i % kRow),
                                              neighborhood.first[2] + int(i / kRow), 0) +
                                       x),
                                  Row);
    return;
  }
  // The second half of the rows of one brick, and the first half of those of the next.
  std::array<std::array<float, 2 * kRow>, kRow * kRow> halves;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int y = neighborhood.first[1] + int(i % kRow), z = neighborhood.first[2] + int(i / kRow);
    std::copy_n(row_at(neighborhood, y, z, 0) + kRow, kRow, halves[i].begin());
    std::copy_n(row_at(neighborhood, y, z, 1), kRow, halves[i].begin() + kRow);
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = __builtin_convertvector(load(&halves[i][std::size_t(x) - kRow]), Row);
}

/// Weighted sum of four vectors.
LEFORT_INLINE Row sum(const std::array<double, kRow>& weights, const Row& a, const Row& b,
                      const Row& c, const Row& d) {
  return (weights[0] * a + weights[1] * b) + (weights[2] * c + weights[3] * d);
}

LEFORT_INLINE double sum(const std::array<double, kRow>& weights, const Row& row) {
  Row w;
  std::memcpy(&w, weights.data(), sizeof(w));
  const Row product = w * row;
  return (product[0] + product[1]) + (product[2] + product[3]);
}

LEFORT_INLINE void evaluate(const Neighborhood& neighborhood, SplineValue& result) {
  std::array<Row, kRow * kRow> rows;
  read_rows(neighborhood, rows);
  const Weights x = weights_at(neighborhood.t[0]), y = weights_at(neighborhood.t[1]),
                z = weights_at(neighborhood.t[2]);

  std::array<Row, kRow> value, slope, curvature;  // Interpolated along z, by y.
  for (std::size_t j = 0; j < kRow; ++j) {
    const Row &a = rows[j], &b = rows[kRow + j], &c = rows[2 * kRow + j], &d = rows[3 * kRow + j];
    value[j] = sum(z.value, a, b, c, d);
    slope[j] = sum(z.slope, a, b, c, d);
    curvature[j] = sum(z.curvature, a, b, c, d);
  }
  const auto along_y = [](const std::array<double, kRow>& weights, const std::array<Row, kRow>& r)
      __attribute__((always_inline)) {
    return sum(weights, r[0], r[1], r[2], r[3]);
  };
  const Row at = along_y(y.value, value), dy = along_y(y.slope, value),
            dyy = along_y(y.curvature, value), dz = along_y(y.value, slope),
            dyz = along_y(y.slope, slope), dzz = along_y(y.value, curvature);

  result.value = sum(x.value, at);
  result.gradient = Vec3(sum(x.slope, at), sum(x.value, dy), sum(x.value, dz));
  Mat3& hessian = result.hessian;
  hessian(0, 0) = sum(x.curvature, at);
  hessian(1, 1) = sum(x.value, dyy);
  hessian(2, 2) = sum(x.value, dzz);
  hessian(0, 1) = hessian(1, 0) = sum(x.slope, dy);
  hessian(0, 2) = hessian(2, 0) = sum(x.slope, dz);
  hessian(1, 2) = hessian(2, 1) = sum(x.value, dyz);
}

LEFORT_INLINE void evaluate_all(const SparseLattice& lattice, std::span<const Vec3> u,
                                std::span<SplineValue> values) {
  std::array<Neighborhood, kGroup> neighborhoods;
  for (std::size_t begin = 0; begin < u.size(); begin += kGroup) {
    const std::size_t count = std::min(kGroup, u.size() - begin);
    for (std::size_t i = 0; i < count; ++i) locate(lattice, u[begin + i], neighborhoods[i]);
    for (std::size_t i = 0; i < count; ++i) evaluate(neighborhoods[i], values[begin + i]);
  }
}

#if defined(__x86_64__)
LEFORT_AVX2 void evaluate_avx2(const SparseLattice& lattice, std::span<const Vec3> u,
                               std::span<SplineValue> values) {
  evaluate_all(lattice, u, values);
}
#endif

}  // namespace

void evaluate_splines(const SparseLattice& lattice, std::span<const Vec3> u,
                      std::span<SplineValue> values, Simd simd) {
  LEFORT_CHECK(u.size() == values.size());
#if defined(__x86_64__)
  if (simd != Simd::kBaseline) return evaluate_avx2(lattice, u, values);
#endif
  evaluate_all(lattice, u, values);
}

SplineValue evaluate_spline(const SparseLattice& lattice, const Vec3& u) {
  SplineValue value{};
  evaluate_splines(lattice, std::span(&u, 1), std::span(&value, 1));
  return value;
}

}  // namespace lefort::field
