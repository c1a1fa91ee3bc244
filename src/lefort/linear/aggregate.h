/// \file
/// Groups of neighboring nodes, and the coarse space they span.
#pragma once

#include <lefort/linear/block_matrix.h>

#include <cstdint>
#include <vector>

namespace lefort::linear {

/// Which aggregate each block row belongs to.
struct Aggregates {
  std::int32_t count = 0;
  std::vector<std::int32_t> of_row;
};

/// Groups block rows with their strongly coupled neighbors (\cite vanek1996, algorithm 5.1): i and
/// j are strongly coupled if |A_ij| > threshold sqrt(|A_ii| |A_jj|).
template <int kRows>
[[nodiscard]] Aggregates aggregate(const BlockMatrix<kRows, kRows>& A, double threshold);

/// Six columns of a matrix of kRows rows per block row: what it barely resists (near null space).
template <int kRows>
using Modes = std::vector<Eigen::Matrix<double, kRows, 6>>;

/// The coarse space of aggregates: the modes, each aggregate's part made orthonormal.
template <int kRows>
struct CoarseSpace {
  BlockMatrix<kRows, 6> basis;  ///< One block a row.
  Modes<6> modes;               ///< The modes in the coarse space: basis * modes are the fine ones.
};

/// Modes that depend on others within an aggregate (a single node cannot turn) leave columns of
/// zeros in the basis.
template <int kRows>
[[nodiscard]] CoarseSpace<kRows> coarse_space(const Aggregates& aggregates,
                                              const Modes<kRows>& modes);

}  // namespace lefort::linear
