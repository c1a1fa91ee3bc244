/// \file
/// Symbolic analysis of a sparse Cholesky factorization: everything that depends on the pattern
/// only.
///
/// Columns of the factor with the same pattern below the diagonal form a supernode. A supernode is
/// merged with its parent where this adds few zeros. Its front is a dense matrix over its own rows
/// and those rows below them in which its columns have entries. The front is assembled from entries
/// of A and from the update matrices of the children in the assembly tree; its own rows are
/// eliminated, and what remains is its update matrix, which is added to the front of the parent
/// (multifrontal method; \cite duff1983,
/// \cite liu1992).
#pragma once

#include <lefort/linear/sparse_matrix.h>
#include <lefort/linear/tile_layout.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lefort::linear {

/// Rows of a front: own rows, then those below; both are padded to multiples of kLane.
struct Supernode {
  std::int32_t first_row = 0;  ///< In the elimination order.
  std::int32_t own = 0;        ///< Number of rows it eliminates, > 0.
  std::int32_t below = 0;      ///< Number of rows of its update matrix.
  std::int32_t parent = -1;    ///< -1 for a root.
  /// The subtree of supernode s consists of the supernodes first_descendant to s.
  std::int32_t first_descendant = 0;
  /// Offset of its panel (its columns of the factor) in the factor, in entries.
  std::int64_t panel = 0;
  std::int64_t rows_offset = 0;  ///< Offset of its rows in a vector over the rows of all fronts.
  double work = 0.0;             ///< Multiplications to eliminate its subtree.

  /// Layouts of its columns of the factor, and of its update matrix.
  [[nodiscard]] TileLayout panel_layout() const { return {padded(own), padded(below)}; }
  [[nodiscard]] TileLayout update_layout() const { return {padded(below), 0}; }
};

/// A run of rows below the own rows of a front: consecutive in this front and in the front of its
/// parent, within one tile of each.
struct RowRun {
  std::int32_t row;         ///< First row, counted from the first row below the own rows.
  std::int32_t parent_row;  ///< Its row in the front of the parent.
  std::int32_t count;
};

/// Where an entry of A is added.
struct EntryTarget {
  std::int32_t entry;    ///< Position in the values of A.
  std::uint32_t offset;  ///< Offset in the panel of the supernode.
};

/// Elimination order, supernodes and index lists of a factorization.
struct CholeskyPlan {
  std::vector<std::int32_t> order;     ///< Rows of A in the order of elimination.
  std::vector<Supernode> supernodes;   ///< Children before parents, subtrees contiguous.
  std::vector<std::int32_t> children;  ///< Of all supernodes in turn, then the roots.
  std::vector<std::int32_t> child_start;
  std::vector<RowRun> runs;
  std::vector<std::int64_t> run_start;
  std::vector<EntryTarget> entries;
  std::vector<std::int64_t> entry_start;
  std::int64_t factor_entries = 0;  ///< Size of the factor, with padding.
  std::int64_t front_rows = 0;      ///< Rows of all fronts.
  /// Max total entries of the update matrices that exist at the same time, if one thread
  /// factorizes.
  std::int64_t peak_update = 0;

  [[nodiscard]] std::span<const std::int32_t> roots() const {
    return part(children, child_start, std::int32_t(supernodes.size()));
  }
  [[nodiscard]] std::span<const std::int32_t> children_of(std::int32_t s) const {
    return part(children, child_start, s);
  }
  [[nodiscard]] std::span<const RowRun> runs_of(std::int32_t s) const {
    return part(runs, run_start, s);
  }
  [[nodiscard]] std::span<const EntryTarget> entries_of(std::int32_t s) const {
    return part(entries, entry_start, s);
  }
  /// Multiplications of the whole factorization.
  [[nodiscard]] double work() const;

 private:
  template <class Item, class Start>
  static std::span<const Item> part(const std::vector<Item>& items, const std::vector<Start>& start,
                                    std::int32_t s) {
    const auto begin = std::size_t(start[std::size_t(s)]),
               end = std::size_t(start[std::size_t(s) + 1]);
    return std::span(items).subspan(begin, end - begin);
  }
};

/// Analyzes the pattern of a matrix.
///
/// \param A  lower triangle with the whole diagonal, compressed, rows ascending.
/// \returns nothing if memory was exhausted.
[[nodiscard]] std::optional<CholeskyPlan> plan_cholesky(const SparseMatrix& A);

}  // namespace lefort::linear
