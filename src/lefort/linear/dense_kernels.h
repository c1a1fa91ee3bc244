/// \file
/// Dense kernels for the tiles of the sparse factorization.
///
/// A tile is column-major; its leading dimension is its number of rows. Rows and columns are
/// multiples of kLane and at most kTile: then two tiles and their product stay in the private cache
/// of a core and are read in place, without the packing of a general matrix product.
#pragma once

#include <cstdint>

namespace lefort::linear {

/// Rows and columns of a tile are multiples of this: the doubles in the widest register.
inline constexpr int kLane = 8;

/// Max rows or columns of a tile: a multiple of all register blocks, and an odd number of cache
/// lines per column, so that columns do not compete for the same cache sets.
inline constexpr int kTile = 120;

/// Instruction sets that the kernels are compiled for. kAvx2 and kAvx512 fuse multiplication and
/// addition in the same order and give the same bits. kBaseline is for x86 processors before 2013,
/// which cannot fuse, and for all other architectures.
enum class TileSimd : std::uint8_t { kBaseline, kAvx2, kAvx512 };

/// \returns the widest instruction set of this processor.
[[nodiscard]] TileSimd best_tile_simd();

/// The kernels for one instruction set.
struct TileKernels {
  /// C -= A B^T, and C = -A B^T; A is rows x depth, B is columns x depth, depth is any number up to
  /// kTile.
  void (*subtract_product)(double* C, const double* A, const double* B, int rows, int columns,
                           int depth);
  void (*minus_product)(double* C, const double* A, const double* B, int rows, int columns,
                        int depth);

  /// C -= A A^T, and C = -A A^T; A is rows x depth. Valid in the lower triangle; entries above it
  /// are undefined.
  void (*subtract_square)(double* C, const double* A, int rows, int depth);
  void (*minus_square)(double* C, const double* A, int rows, int depth);

  /// C = L L^T in place. Reads only the lower triangle; entries above it become undefined.
  ///
  /// \returns false if a pivot is not positive.
  bool (*factorize)(double* C, int rows);

  /// X := X L^-T; X is rows x columns. Reads only the lower triangle of L.
  void (*divide_by_factor)(double* X, const double* L, int rows, int columns);

  /// x := L^-1 x, and x := L^-T x.
  void (*solve_forward)(double* x, const double* L, int rows);
  void (*solve_backward)(double* x, const double* L, int rows);

  /// y -= A x, and y -= A^T x; A is rows x columns.
  void (*subtract_times)(double* y, const double* A, const double* x, int rows, int columns);
  void (*subtract_transposed_times)(double* y, const double* A, const double* x, int rows,
                                    int columns);
};

/// \returns the kernels for an instruction set.
[[nodiscard]] const TileKernels& tile_kernels(TileSimd simd = best_tile_simd());

}  // namespace lefort::linear
