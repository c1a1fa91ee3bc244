/// \file
/// The arithmetic of small dense blocks behind the sparse factorization.
///
/// A tile is column-major, its columns as far apart as it has rows. Rows and columns are multiples
/// of kLane, at most kTile: then two tiles and their product stay in a core's own cache and are
/// read in place, without the repacking that a general matrix product begins with.
#pragma once

#include <cstdint>

namespace lefort::linear {

/// Rows and columns of a tile come in multiples of this: the doubles of the widest register.
inline constexpr int kLane = 8;

/// The most rows or columns of a tile. A multiple of all register blocks; columns of an odd number
/// of cache lines do not compete for the same places of the cache.
inline constexpr int kTile = 120;

/// Instruction sets the loops are compiled for. kAvx2 and kAvx512 fuse multiplication and addition
/// in the same order and give the same bits; kBaseline, for processors of before 2013, cannot fuse.
enum class TileSimd : std::uint8_t { kBaseline, kAvx2, kAvx512 };

/// The best that this processor has.
[[nodiscard]] TileSimd best_tile_simd();

/// The loops for one instruction set.
struct TileKernels {
  /// C -= A B^T, and C = -A B^T; A is rows by depth, B columns by depth, depth any number up to
  /// kTile.
  void (*subtract_product)(double* C, const double* A, const double* B, int rows, int columns,
                           int depth);
  void (*minus_product)(double* C, const double* A, const double* B, int rows, int columns,
                        int depth);

  /// C -= A A^T, and C = -A A^T; A is rows by depth. Right in the lower triangle; above it, C
  /// becomes noise.
  void (*subtract_square)(double* C, const double* A, int rows, int depth);
  void (*minus_square)(double* C, const double* A, int rows, int depth);

  /// C = L L^T in place. The lower triangle alone is read; above it, C becomes noise.
  /// \returns false if a pivot is not positive.
  bool (*factorize)(double* C, int rows);

  /// X := X L^-T; X is rows by columns, and of L the lower triangle alone is read.
  void (*divide_by_factor)(double* X, const double* L, int rows, int columns);

  /// x := L^-1 x, and x := L^-T x.
  void (*solve_forward)(double* x, const double* L, int rows);
  void (*solve_backward)(double* x, const double* L, int rows);

  /// y -= A x, and y -= A^T x; A is rows by columns.
  void (*subtract_times)(double* y, const double* A, const double* x, int rows, int columns);
  void (*subtract_transposed_times)(double* y, const double* A, const double* x, int rows,
                                    int columns);
};

[[nodiscard]] const TileKernels& tile_kernels(TileSimd simd = best_tile_simd());

}  // namespace lefort::linear
