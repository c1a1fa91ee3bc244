/// \file
/// Aggregates of neighboring nodes, and the coarse space they span.
#pragma once

#include <lefort/linear/block_matrix.h>

#include <cstdint>
#include <vector>

namespace lefort::linear {

/// A partition of the block rows into aggregates.
struct Aggregates {
  std::int32_t count = 0;
  std::vector<std::int32_t> of_row;
};

/// Groups block rows with their strongly coupled neighbors (\cite vanek1996, algorithm 5.1).
///
/// \param A          symmetric.
/// \param threshold  i and j are strongly coupled if |A_ij| > threshold sqrt(|A_ii| |A_jj|);
///   Frobenius norms.
template <int kRows>
[[nodiscard]] Aggregates aggregate(const BlockMatrix<kRows, kRows>& A, double threshold);

/// The near null space of a matrix: six columns, one block of kRows rows per block row.
template <int kRows>
using Modes = std::vector<Eigen::Matrix<double, kRows, 6>>;

/// The coarse space of aggregates: the modes, orthonormalized on each aggregate.
template <int kRows>
struct CoarseSpace {
  BlockMatrix<kRows, 6> basis;  ///< One block per block row.
  /// The modes in the coarse space; basis * modes are the modes given to coarse_space().
  Modes<6> modes;
};

/// Builds the coarse space. A mode that, restricted to an aggregate, is a linear combination of the
/// modes before it (a rotation, if the aggregate is one node) gives a zero column of the basis.
///
/// \param aggregates  of the rows.
/// \param modes       near null space of the matrix.
template <int kRows>
[[nodiscard]] CoarseSpace<kRows> coarse_space(const Aggregates& aggregates,
                                              const Modes<kRows>& modes);

}  // namespace lefort::linear
