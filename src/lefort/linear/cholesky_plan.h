/// \file
/// The symbolic half of a sparse Cholesky factorization: all that depends on the pattern alone.
///
/// Rows that end up with one pattern below the diagonal are eliminated together, as a supernode. It
/// assembles a dense matrix of its own rows and those below them (its front) from entries of A and
/// from what its children in the elimination tree leave behind, eliminates its own rows and leaves
/// the rest to its parent (multifrontal method; \cite duff1983, \cite liu1992).
#pragma once

#include <lefort/linear/sparse_matrix.h>
#include <lefort/linear/tile_layout.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lefort::linear {

/// Rows of a front, own and then below; each part is padded to whole lanes.
struct Supernode {
  std::int32_t first_row = 0;         ///< In the order of elimination.
  std::int32_t own = 0;               ///< How many rows it eliminates, > 0,
  std::int32_t below = 0;             ///< and how many it leaves to its parent.
  std::int32_t parent = -1;           ///< -1 if it is a root.
  std::int32_t first_descendant = 0;  ///< Its subtree is the supernodes from this to itself.
  std::int64_t panel = 0;             ///< Where its columns of the factor begin.
  std::int64_t rows_place = 0;  ///< Where its rows begin in a vector over the rows of all fronts.
  double work = 0.0;            ///< Multiplications to eliminate its subtree.

  /// The columns of the factor, and what is left to the parent.
  [[nodiscard]] TileLayout panel_layout() const { return {padded(own), padded(below)}; }
  [[nodiscard]] TileLayout rest_layout() const { return {padded(below), 0}; }
};

/// Consecutive rows below a front that are consecutive in its parent's, within one tile of each.
struct RowRun {
  std::int32_t row;         ///< The first, counted from the first row below.
  std::int32_t parent_row;  ///< Its row in the parent's front.
  std::int32_t count;
};

/// Where an entry of A goes.
struct EntryPlace {
  std::int32_t entry;   ///< Among the values of A.
  std::uint32_t place;  ///< Among those of the supernode's panel.
};

struct CholeskyPlan {
  std::vector<std::int32_t> order;     ///< Row of A that is eliminated first, second, ...
  std::vector<Supernode> supernodes;   ///< Children before parents, subtrees in one piece.
  std::vector<std::int32_t> children;  ///< Of all supernodes; after them, the roots.
  std::vector<std::int32_t> child_start;
  std::vector<RowRun> runs;
  std::vector<std::int64_t> run_start;
  std::vector<EntryPlace> entries;
  std::vector<std::int64_t> entry_start;
  std::int64_t factor_numbers = 0;  ///< The factor, with padding.
  std::int64_t front_rows = 0;      ///< Rows of all fronts.
  std::int64_t peak_rest = 0;       ///< The most numbers that wait for parents, on one thread.

  [[nodiscard]] std::span<const std::int32_t> roots() const {
    return part(children, child_start, std::int32_t(supernodes.size()));
  }
  [[nodiscard]] std::span<const std::int32_t> children_of(std::int32_t s) const {
    return part(children, child_start, s);
  }
  [[nodiscard]] std::span<const RowRun> runs_of(std::int32_t s) const {
    return part(runs, run_start, s);
  }
  [[nodiscard]] std::span<const EntryPlace> entries_of(std::int32_t s) const {
    return part(entries, entry_start, s);
  }
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

/// \param A  lower triangle with the whole diagonal, compressed, rows ascending.
/// \returns nothing if memory ran out.
[[nodiscard]] std::optional<CholeskyPlan> plan_cholesky(const SparseMatrix& A);

}  // namespace lefort::linear
