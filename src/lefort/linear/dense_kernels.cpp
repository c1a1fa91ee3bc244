#include <lefort/linear/dense_kernels.h>

#include <array>
#include <cmath>
#include <cstddef>

// Compiled with -ffp-contract=fast. Each product below is added to exactly one sum, so there is
// only one way to fuse multiplications and additions.

namespace lefort::linear {
namespace {

#define LEFORT_INLINE inline __attribute__((always_inline))

// Generic vectors: the compiler maps them to the registers of each target.
template <int kLanes>
struct LanesOf;
template <>
struct LanesOf<2> {
  using Type = double __attribute__((vector_size(16), aligned(8)));
};
template <>
struct LanesOf<4> {
  using Type = double __attribute__((vector_size(32), aligned(8)));
};
template <>
struct LanesOf<8> {
  using Type = double __attribute__((vector_size(64), aligned(8)));
};
template <int kLanes>
using Lanes = typename LanesOf<kLanes>::Type;
using Lane = Lanes<kLane>;

template <class Vector>
LEFORT_INLINE Vector load(const double* at) {
  return *reinterpret_cast<const Vector*>(at);
}
template <class Vector>
LEFORT_INLINE void store(double* at, const Vector& value) {
  *reinterpret_cast<Vector*>(at) = value;
}
LEFORT_INLINE double* column(double* tile, int rows, int j) {
  return tile + std::size_t(j) * std::size_t(rows);
}
LEFORT_INLINE const double* column(const double* tile, int rows, int j) {
  return tile + std::size_t(j) * std::size_t(rows);
}

/// Whether the product is subtracted from C or overwrites it.
enum class Product { kSubtract, kOverwrite };

/// A block of C with kVectors registers by kColumns, which stays in registers.
template <Product kProduct, int kLanes, int kVectors, int kColumns>
LEFORT_INLINE void subtract_piece(double* C, const double* A, const double* B, int rows,
                                  int columns, int depth) {
  using Vector = Lanes<kLanes>;
  Vector sum[kColumns][kVectors] = {};
  for (int p = 0; p < depth; ++p, A += rows, B += columns) {
    Vector a[kVectors];
    for (int v = 0; v < kVectors; ++v) a[v] = load<Vector>(A + v * kLanes);
    for (int j = 0; j < kColumns; ++j)
      for (int v = 0; v < kVectors; ++v) sum[j][v] += a[v] * (Vector{} + B[j]);
  }
  for (int j = 0; j < kColumns; ++j)
    for (int v = 0; v < kVectors; ++v) {
      double* const at = column(C, rows, j) + v * kLanes;
      store<Vector>(at, (kProduct == Product::kSubtract ? load<Vector>(at) : Vector{}) - sum[j][v]);
    }
}

/// Rows `from` to `rows` of kColumns columns of C -= A B^T.
template <Product kProduct, int kLanes, int kColumns>
LEFORT_INLINE void subtract_columns(double* C, const double* A, const double* B, int from, int rows,
                                    int columns, int depth) {
  int i = from;
  for (; i + 3 * kLanes <= rows; i += 3 * kLanes)
    subtract_piece<kProduct, kLanes, 3, kColumns>(C + i, A + i, B, rows, columns, depth);
  for (; i + 2 * kLanes <= rows; i += 2 * kLanes)
    subtract_piece<kProduct, kLanes, 2, kColumns>(C + i, A + i, B, rows, columns, depth);
  for (; i < rows; i += kLanes)
    subtract_piece<kProduct, kLanes, 1, kColumns>(C + i, A + i, B, rows, columns, depth);
}

template <Product kProduct, int kLanes, int kColumns>
LEFORT_INLINE void subtract_product(double* C, const double* A, const double* B, int rows,
                                    int columns, int depth) {
  for (int j = 0; j < columns; j += kColumns)
    subtract_columns<kProduct, kLanes, kColumns>(column(C, rows, j), A, B + j, 0, rows, columns,
                                                 depth);
}

template <Product kProduct, int kLanes, int kColumns>
LEFORT_INLINE void subtract_square(double* C, const double* A, int rows, int depth) {
  for (int j = 0; j < rows; j += kColumns)
    subtract_columns<kProduct, kLanes, kColumns>(column(C, rows, j), A, A + j, j / kLane * kLane,
                                                 rows, rows, depth);
}

/// The diagonal block of kLane rows at C, columns `rows` apart: C = L L^T.
LEFORT_INLINE bool factorize_triangle(double* C, int rows) {
  for (int j = 0; j < kLane; ++j) {
    double pivot = column(C, rows, j)[j];
    for (int k = 0; k < j; ++k) pivot -= column(C, rows, k)[j] * column(C, rows, k)[j];
    if (!(pivot > 0.0)) return false;
    const double root = std::sqrt(pivot);
    column(C, rows, j)[j] = root;
    for (int i = j + 1; i < kLane; ++i) {
      double entry = column(C, rows, j)[i];
      for (int k = 0; k < j; ++k) entry -= column(C, rows, k)[i] * column(C, rows, k)[j];
      column(C, rows, j)[i] = entry / root;
    }
  }
  return true;
}

/// X := X L^-T for kLane columns of X from row `from` on, and a diagonal block L of kLane rows.
///
/// \param height  distance of the columns of L.
template <int kLanes>
LEFORT_INLINE void divide_by_triangle(double* X, const double* L, int from, int rows, int height) {
  using Vector = Lanes<kLanes>;
  double inverse[kLane];
  for (int c = 0; c < kLane; ++c) inverse[c] = 1.0 / column(L, height, c)[c];
  for (int i = from; i < rows; i += kLanes) {
    Vector x[kLane];
    for (int c = 0; c < kLane; ++c) {
      x[c] = load<Vector>(column(X, rows, c) + i);
      for (int k = 0; k < c; ++k) x[c] -= x[k] * (Vector{} + column(L, height, k)[c]);
      x[c] = x[c] * inverse[c];
      store<Vector>(column(X, rows, c) + i, x[c]);
    }
  }
}

template <int kLanes, int kColumns>
LEFORT_INLINE bool factorize(double* C, int rows) {
  for (int j = 0; j < rows; j += kLane) {
    for (int c = j; c < j + kLane; c += kColumns)
      subtract_columns<Product::kSubtract, kLanes, kColumns>(column(C, rows, c), C, C + c, j, rows,
                                                             rows, j);
    double* const strip = column(C, rows, j);
    if (!factorize_triangle(strip + j, rows)) return false;
    divide_by_triangle<kLanes>(strip, strip + j, j + kLane, rows, rows);
  }
  return true;
}

template <int kLanes, int kColumns>
LEFORT_INLINE void divide_by_factor(double* X, const double* L, int rows, int columns) {
  for (int j = 0; j < columns; j += kLane) {
    for (int c = j; c < j + kLane; c += kColumns)
      subtract_columns<Product::kSubtract, kLanes, kColumns>(column(X, rows, c), X, L + c, 0, rows,
                                                             columns, j);
    divide_by_triangle<kLanes>(column(X, rows, j), column(L, columns, j) + j, 0, rows, columns);
  }
}

// The loops below read each entry of a matrix once and are limited by memory bandwidth.
constexpr int kColumnsPerPass = 4;  ///< Columns per pass.
static_assert(kLane % kColumnsPerPass == 0);

/// \param height  distance of the columns of A.
LEFORT_INLINE void subtract_times(double* y, const double* A, const double* x, int rows,
                                  int columns, int height) {
  for (int j = 0; j < columns; j += kColumnsPerPass)
    for (int i = 0; i < rows; i += kLane) {
      Lane sum = load<Lane>(y + i);
      for (int c = 0; c < kColumnsPerPass; ++c)
        sum -= load<Lane>(column(A, height, j + c) + i) * (Lane{} + x[j + c]);
      store<Lane>(y + i, sum);
    }
}

/// \param height  distance of the columns of A.
LEFORT_INLINE void subtract_transposed_times(double* y, const double* A, const double* x, int rows,
                                             int columns, int height) {
  for (int j = 0; j < columns; j += kColumnsPerPass) {
    Lane sums[kColumnsPerPass] = {};
    for (int i = 0; i < rows; i += kLane) {
      const Lane x_i = load<Lane>(x + i);
      for (int c = 0; c < kColumnsPerPass; ++c)
        sums[c] += load<Lane>(column(A, height, j + c) + i) * x_i;
    }
    for (int c = 0; c < kColumnsPerPass; ++c) {
      double sum = 0.0;
      for (int l = 0; l < kLane; ++l) sum += sums[c][l];
      y[j + c] -= sum;
    }
  }
}

LEFORT_INLINE void solve_forward(double* x, const double* L, int rows) {
  for (int j = 0; j < rows; j += kLane) {
    for (int c = j; c < j + kLane; ++c) {
      for (int k = j; k < c; ++k) x[c] -= column(L, rows, k)[c] * x[k];
      x[c] /= column(L, rows, c)[c];
    }
    const int below = j + kLane;
    subtract_times(x + below, column(L, rows, j) + below, x + j, rows - below, kLane, rows);
  }
}

LEFORT_INLINE void solve_backward(double* x, const double* L, int rows) {
  for (int j = rows - kLane; j >= 0; j -= kLane) {
    const int below = j + kLane;
    subtract_transposed_times(x + j, column(L, rows, j) + below, x + below, rows - below, kLane,
                              rows);
    for (int c = j + kLane - 1; c >= j; --c) {
      for (int k = c + 1; k < j + kLane; ++k) x[c] -= column(L, rows, c)[k] * x[k];
      x[c] /= column(L, rows, c)[c];
    }
  }
}

// Registers of kLanes doubles; blocks of three of them by kColumns fill the register file.
#define LEFORT_TILE_KERNELS(name, attribute, kLanes, kColumns)                                    \
  struct name {                                                                                   \
    attribute static void product(double* C, const double* A, const double* B, int rows,          \
                                  int columns, int depth) {                                       \
      subtract_product<Product::kSubtract, kLanes, kColumns>(C, A, B, rows, columns, depth);      \
    }                                                                                             \
    attribute static void new_product(double* C, const double* A, const double* B, int rows,      \
                                      int columns, int depth) {                                   \
      subtract_product<Product::kOverwrite, kLanes, kColumns>(C, A, B, rows, columns, depth);     \
    }                                                                                             \
    attribute static void square(double* C, const double* A, int rows, int depth) {               \
      subtract_square<Product::kSubtract, kLanes, kColumns>(C, A, rows, depth);                   \
    }                                                                                             \
    attribute static void new_square(double* C, const double* A, int rows, int depth) {           \
      subtract_square<Product::kOverwrite, kLanes, kColumns>(C, A, rows, depth);                  \
    }                                                                                             \
    attribute static bool factor(double* C, int rows) {                                           \
      return factorize<kLanes, kColumns>(C, rows);                                                \
    }                                                                                             \
    attribute static void divide(double* X, const double* L, int rows, int columns) {             \
      divide_by_factor<kLanes, kColumns>(X, L, rows, columns);                                    \
    }                                                                                             \
    attribute static void forward(double* x, const double* L, int rows) {                         \
      solve_forward(x, L, rows);                                                                  \
    }                                                                                             \
    attribute static void backward(double* x, const double* L, int rows) {                        \
      solve_backward(x, L, rows);                                                                 \
    }                                                                                             \
    attribute static void times(double* y, const double* A, const double* x, int rows,            \
                                int columns) {                                                    \
      subtract_times(y, A, x, rows, columns, rows);                                               \
    }                                                                                             \
    attribute static void transposed_times(double* y, const double* A, const double* x, int rows, \
                                           int columns) {                                         \
      subtract_transposed_times(y, A, x, rows, columns, rows);                                    \
    }                                                                                             \
    static constexpr TileKernels kTable = {product, new_product,     square,  new_square,         \
                                           factor,  divide,          forward, backward,           \
                                           times,   transposed_times};                            \
  }

LEFORT_TILE_KERNELS(Baseline, , 2, 2);
#if defined(__x86_64__)
LEFORT_TILE_KERNELS(Avx2, __attribute__((target("avx2,fma"))), 4, 4);
LEFORT_TILE_KERNELS(Avx512, __attribute__((target("avx512f,avx512vl,fma,prefer-vector-width=512"))),
                    8, 8);
#endif

}  // namespace

TileSimd best_tile_simd() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl"))
    return TileSimd::kAvx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return TileSimd::kAvx2;
#endif
  return TileSimd::kBaseline;
}

const TileKernels& tile_kernels(TileSimd simd) {
#if defined(__x86_64__)
  if (simd == TileSimd::kAvx512) return Avx512::kTable;
  if (simd == TileSimd::kAvx2) return Avx2::kTable;
#endif
  return Baseline::kTable;
}

}  // namespace lefort::linear
