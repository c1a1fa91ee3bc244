#include <lefort/core/check.h>
#include <lefort/linear/assembly_tree_tasks.h>
#include <lefort/linear/sparse_cholesky.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <new>
#include <utility>
#include <vector>

namespace lefort::linear {
namespace {

/// Below this reciprocal condition number (estimated by the squared ratio of extreme pivots) the
/// matrix counts as singular.
constexpr double kSingular = 1e-15;

/// Runs of a child that one task adds to a front, and tiles that one task reads.
constexpr Index kRunsPerTask = 16;
constexpr Index kTilesPerTask = 8;

/// Limits the sum of allocated memory.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::int64_t bytes) : left_(bytes) {}

  /// \returns an empty buffer if the budget is exceeded.
  [[nodiscard]] AlignedBuffer allocate(std::int64_t numbers) {
    const std::int64_t bytes = numbers * std::int64_t(sizeof(double));
    if (left_.fetch_sub(bytes) < bytes) return {};
    return AlignedBuffer(numbers);
  }
  void release(std::int64_t numbers) { left_ += numbers * std::int64_t(sizeof(double)); }

 private:
  std::atomic<std::int64_t> left_;
};

/// One numeric factorization.
class Elimination {
 public:
  Elimination(const CholeskyPlan& plan, std::span<const double> values, double* factor,
              const TileKernels& kernels, std::int64_t memory_bytes)
      : plan_(plan), values_(values), factor_(factor), kernels_(kernels), memory_(memory_bytes) {
    updates_.resize(plan.supernodes.size());
  }

  [[nodiscard]] LinearSolveStatus run() {
    visit_upwards(plan_, [&](std::int32_t s, FrontLoops loops) {
      if (outcome_.load() == LinearSolveStatus::kDone) eliminate(s, loops);
    });
    return outcome_.load();
  }

 private:
  void eliminate(std::int32_t s, FrontLoops loops) {
    const Supernode& node = plan_.supernodes[std::size_t(s)];
    double* const panel = factor_ + node.panel;
    clear_panel(node, loops);
    for (const EntryTarget& target : plan_.entries_of(s))
      panel[target.offset] += values_[std::size_t(target.entry)];
    for (const std::int32_t child : plan_.children_of(s)) add_to_panel(child, node, loops);
    if (!factorize_panel(node, loops)) return fail(LinearSolveStatus::kNotPositiveDefinite);

    AlignedBuffer& update = updates_[std::size_t(s)];
    if (node.below > 0) {
      update = memory_.allocate(node.update_layout().entry_count());
      if (!update) return fail(LinearSolveStatus::kOutOfMemory);
      compute_update(node, update.data(), loops);
    }
    for (const std::int32_t child : plan_.children_of(s)) {
      if (node.below > 0) add_to_update(child, node, update.data(), loops);
      memory_.release(plan_.supernodes[std::size_t(child)].update_layout().entry_count());
      updates_[std::size_t(child)] = {};
    }
  }

  void fail(LinearSolveStatus why) {
    // If several supernodes fail, any status is valid.
    outcome_.store(why);
  }

  /// Sets the panel to zero, except for ones on the padded diagonal.
  void clear_panel(const Supernode& node, FrontLoops loops) const {
    constexpr Index kEntriesPerTask = Index(1) << 17;
    const TileLayout layout = node.panel_layout();
    double* const panel = factor_ + node.panel;
    const Index count = layout.entry_count();
    loop_in_front(loops, (count + kEntriesPerTask - 1) / kEntriesPerTask, [&](Index part) {
      std::fill(panel + part * kEntriesPerTask,
                panel + std::min(count, (part + 1) * kEntriesPerTask), 0.0);
    });
    const int last = layout.own_tiles() - 1;
    for (std::int32_t i = node.own; i < padded(node.own); ++i)
      panel[layout.offset(last, last) +
            std::int64_t(i - layout.start(last)) * (layout.size(last) + 1)] = 1.0;
  }

  /// Number of leading runs of a child whose rows its parent eliminates.
  [[nodiscard]] std::size_t runs_to_panel(std::int32_t child, const Supernode& parent) const {
    const auto runs = plan_.runs_of(child);
    return std::size_t(
        std::partition_point(runs.begin(), runs.end(),
                             [&](const RowRun& run) { return run.parent_row < parent.own; }) -
        runs.begin());
  }

  void add_to_panel(std::int32_t child, const Supernode& parent, FrontLoops loops) const {
    add_columns(child, 0, runs_to_panel(child, parent), parent.panel_layout(), 0,
                factor_ + parent.panel, loops);
  }

  /// \param update  update matrix of the parent.
  void add_to_update(std::int32_t child, const Supernode& parent, double* update,
                     FrontLoops loops) const {
    add_columns(child, runs_to_panel(child, parent), plan_.runs_of(child).size(),
                parent.update_layout(), padded(parent.own), update, loops);
  }

  /// Adds the columns of the update matrix of a child that are in its runs `first` to `end`.
  ///
  /// \param layout   of the target.
  /// \param skipped  rows of the front of the parent before those of the target.
  void add_columns(std::int32_t child, std::size_t first, std::size_t end, const TileLayout& layout,
                   std::int32_t skipped, double* target, FrontLoops loops) const {
    const auto runs = plan_.runs_of(child);
    const TileLayout from = plan_.supernodes[std::size_t(child)].update_layout();
    const double* const source = updates_[std::size_t(child)].data();
    loop_in_front(
        loops, Index(end - first),
        [&](Index c) {
          const RowRun& columns = runs[first + std::size_t(c)];
          const std::int32_t to_first = columns.parent_row - skipped;
          const int from_j = from.tile_of(columns.row), to_j = layout.tile_of(to_first);
          const std::int32_t from_column = columns.row - from.start(from_j);
          const std::int32_t to_column = to_first - layout.start(to_j);
          for (std::size_t r = first + std::size_t(c); r < runs.size(); ++r) {
            const RowRun& rows = runs[r];
            const std::int32_t to_row = rows.parent_row - skipped;
            const int from_i = from.tile_of(rows.row), to_i = layout.tile_of(to_row);
            const std::int32_t from_height = from.size(from_i), to_height = layout.size(to_i);
            const double* in = source + from.offset(from_i, from_j) +
                               std::int64_t(from_column) * from_height + rows.row -
                               from.start(from_i);
            double* out = target + layout.offset(to_i, to_j) + std::int64_t(to_column) * to_height +
                          to_row - layout.start(to_i);
            const bool on_diagonal = &rows == &columns;
            for (std::int32_t j = 0; j < columns.count; ++j, in += from_height, out += to_height)
              for (std::int32_t i = on_diagonal ? j : 0; i < rows.count; ++i) out[i] += in[i];
          }
        },
        kRunsPerTask);
  }

  /// \returns false if a pivot is not positive.
  bool factorize_panel(const Supernode& node, FrontLoops loops) const {
    const TileLayout layout = node.panel_layout();
    const auto tile = [&](int i, int j) { return factor_ + node.panel + layout.offset(i, j); };
    for (int j = 0; j < layout.own_tiles(); ++j) {
      const int columns = layout.size(j);
      for (int k = 0; k < j; ++k)
        kernels_.subtract_square(tile(j, j), tile(j, k), columns, layout.size(k));
      if (!kernels_.factorize(tile(j, j), columns)) return false;
      loop_in_front(loops, layout.all_tiles() - j - 1, [&](Index t) {
        const int i = j + 1 + int(t), rows = layout.size(i);
        for (int k = 0; k < j; ++k)
          kernels_.subtract_product(tile(i, j), tile(i, k), tile(j, k), rows, columns,
                                    layout.size(k));
        kernels_.divide_by_factor(tile(i, j), tile(j, j), rows, columns);
      });
    }
    return true;
  }

  /// Computes -L L^T from the rows of L below its own rows.
  void compute_update(const Supernode& node, double* update, FrontLoops loops) const {
    const TileLayout layout = node.panel_layout(), to = node.update_layout();
    const int tiles = to.own_tiles(), first = layout.own_tiles();
    const auto tile = [&](int i, int k) {
      return factor_ + node.panel + layout.offset(first + i, k);
    };
    const auto depth = [&](int k) {  // Padding contributes nothing.
      return std::min<std::int32_t>(layout.size(k), node.own - layout.start(k));
    };
    loop_in_front(loops, Index(tiles) * (tiles + 1) / 2, [&](Index t) {
      const auto [i, j] = tile_of_triangle(t);
      double* const target = update + to.offset(i, j);
      for (int k = 0; k < first; ++k) {
        if (i == j) {
          const auto square = k == 0 ? kernels_.minus_square : kernels_.subtract_square;
          square(target, tile(i, k), to.size(i), depth(k));
        } else {
          const auto product = k == 0 ? kernels_.minus_product : kernels_.subtract_product;
          product(target, tile(i, k), tile(j, k), to.size(i), to.size(j), depth(k));
        }
      }
    });
  }

  /// Row and column of the t-th tile of a triangle, in row order.
  static std::pair<int, int> tile_of_triangle(Index t) {
    int row = 0;
    Index before = 0;
    while (before + row < t) before += ++row;
    return {row, int(t - before)};
  }

  const CholeskyPlan& plan_;
  std::span<const double> values_;
  double* factor_;
  const TileKernels& kernels_;
  MemoryBudget memory_;
  std::vector<AlignedBuffer> updates_;  ///< Update matrices of the supernodes.
  std::atomic<LinearSolveStatus> outcome_ = LinearSolveStatus::kDone;
};

/// The squared ratio of the extreme pivots.
double reciprocal_condition(const CholeskyPlan& plan, const double* factor) {
  double minimum = std::numeric_limits<double>::infinity(), maximum = 0.0;
  for (const Supernode& node : plan.supernodes) {
    const TileLayout layout = node.panel_layout();
    for (std::int32_t i = 0; i < node.own; ++i) {
      const int t = i / kTile;
      const double pivot =
          factor[node.panel + layout.offset(t, t) + std::int64_t(i % kTile) * (layout.size(t) + 1)];
      minimum = std::min(minimum, pivot);
      maximum = std::max(maximum, pivot);
    }
  }
  return maximum > 0.0 ? (minimum / maximum) * (minimum / maximum) : 1.0;
}

/// One triangular solve. `x` contains the rows of each front: first the values of its own rows,
/// then those that it passes to its parent or receives from it.
class Substitution {
 public:
  Substitution(const CholeskyPlan& plan, const double* factor, const TileKernels& kernels,
               std::vector<double>& x)
      : plan_(plan), factor_(factor), kernels_(kernels), x_(x.data()) {}

  void forward(std::int32_t s, FrontLoops loops) const {
    const Supernode& node = plan_.supernodes[std::size_t(s)];
    double* const x = x_ + node.rows_offset;
    for (const std::int32_t child : plan_.children_of(s)) {
      const double* const from = below(child);
      for (const RowRun& run : plan_.runs_of(child))
        for (std::int32_t i = 0; i < run.count; ++i) x[run.parent_row + i] += from[run.row + i];
    }
    const TileLayout layout = node.panel_layout();
    for (int j = 0; j < layout.own_tiles(); ++j) {
      double* const x_j = x + layout.start(j);
      kernels_.solve_forward(x_j, tile(node, layout, j, j), layout.size(j));
      loop_in_front(
          loops, layout.all_tiles() - j - 1,
          [&](Index t) {
            const int i = j + 1 + int(t);
            kernels_.subtract_times(x + layout.start(i), tile(node, layout, i, j), x_j,
                                    layout.size(i), layout.size(j));
          },
          kTilesPerTask);
    }
  }

  void backward(std::int32_t s, FrontLoops loops) const {
    const Supernode& node = plan_.supernodes[std::size_t(s)];
    double* const x = x_ + node.rows_offset;
    if (node.parent >= 0) {
      const double* const from = x_ + plan_.supernodes[std::size_t(node.parent)].rows_offset;
      double* const to = below(s);
      for (const RowRun& run : plan_.runs_of(s))
        for (std::int32_t i = 0; i < run.count; ++i) to[run.row + i] = from[run.parent_row + i];
    }
    const TileLayout layout = node.panel_layout();
    const int own = layout.own_tiles();
    loop_in_front(
        loops, own,
        [&](Index j) {
          for (int i = own; i < layout.all_tiles(); ++i)
            subtract_transposed(node, layout, i, int(j), x);
        },
        1);
    for (int j = own - 1; j >= 0; --j) {
      kernels_.solve_backward(x + layout.start(j), tile(node, layout, j, j), layout.size(j));
      loop_in_front(
          loops, j, [&](Index k) { subtract_transposed(node, layout, j, int(k), x); },
          kTilesPerTask);
    }
  }

 private:
  [[nodiscard]] const double* tile(const Supernode& node, const TileLayout& layout, int i,
                                   int j) const {
    return factor_ + node.panel + layout.offset(i, j);
  }
  [[nodiscard]] double* below(std::int32_t s) const {
    const Supernode& node = plan_.supernodes[std::size_t(s)];
    return x_ + node.rows_offset + padded(node.own);
  }
  void subtract_transposed(const Supernode& node, const TileLayout& layout, int i, int j,
                           double* x) const {
    kernels_.subtract_transposed_times(x + layout.start(j), tile(node, layout, i, j),
                                       x + layout.start(i), layout.size(i), layout.size(j));
  }

  const CholeskyPlan& plan_;
  const double* factor_;
  const TileKernels& kernels_;
  double* x_;
};

}  // namespace

SparseCholesky::SparseCholesky(CholeskyPlan plan, std::int64_t memory_bytes, TileSimd simd)
    : plan_(std::move(plan)), memory_bytes_(memory_bytes), kernels_(&tile_kernels(simd)) {}

LinearSolveStatus SparseCholesky::factorize(std::span<const double> values) try {
  LEFORT_CHECK(values.size() == plan_.entries.size());
  factorized_ = false;
  const std::int64_t factor_bytes = plan_.factor_entries * std::int64_t(sizeof(double));
  const std::int64_t update_bytes = plan_.peak_update * std::int64_t(sizeof(double));
  if (factor_bytes + update_bytes > memory_bytes_) return LinearSolveStatus::kOutOfMemory;
  if (!factor_) factor_ = AlignedBuffer(plan_.factor_entries);
  if (!factor_) return LinearSolveStatus::kOutOfMemory;
  Elimination elimination(plan_, values, factor_.data(), *kernels_, memory_bytes_ - factor_bytes);
  const LinearSolveStatus outcome = elimination.run();
  if (outcome != LinearSolveStatus::kDone) return outcome;
  if (!(reciprocal_condition(plan_, factor_.data()) > kSingular))
    return LinearSolveStatus::kNotPositiveDefinite;
  factorized_ = true;
  return LinearSolveStatus::kDone;
} catch (const std::bad_alloc&) {
  return LinearSolveStatus::kOutOfMemory;
}

std::optional<VectorX> SparseCholesky::solve(const VectorX& b) const try {
  LEFORT_CHECK(factorized_ && std::size_t(b.size()) == plan_.order.size());
  std::vector<double> rows(std::size_t(plan_.front_rows), 0.0);
  const auto for_each_row = [&](const auto& visit) {
    parallel_for(Index(plan_.supernodes.size()), [&](Index s) {
      const Supernode& node = plan_.supernodes[std::size_t(s)];
      for (std::int32_t i = 0; i < node.own; ++i)
        visit(rows[std::size_t(node.rows_offset + i)],
              plan_.order[std::size_t(node.first_row + i)]);
    });
  };
  for_each_row([&](double& x, std::int32_t row) { x = b[row]; });
  const Substitution substitution(plan_, factor_.data(), *kernels_, rows);
  visit_upwards(plan_, [&](std::int32_t s, FrontLoops loops) { substitution.forward(s, loops); });
  visit_downwards(plan_,
                  [&](std::int32_t s, FrontLoops loops) { substitution.backward(s, loops); });
  VectorX x(b.size());
  for_each_row([&](double& value, std::int32_t row) { x[row] = value; });
  return x;
} catch (const std::bad_alloc&) {
  return std::nullopt;
}

}  // namespace lefort::linear
