#include <lefort/core/check.h>
#include <lefort/linear/cholesky_plan.h>
#include <lefort/linear/pattern_graph.h>

#include <algorithm>
#include <limits>
#include <new>
#include <numeric>
#include <utility>

namespace lefort::linear {
namespace {

using Numbers = std::vector<std::int32_t>;

std::size_t at(std::int32_t i) { return std::size_t(i); }

/// The elimination tree of a graph in an order: the parent of a vertex is the first later vertex
/// that its elimination connects it with (\cite liu1990). All numbers are positions in the order.
Numbers elimination_tree(const PatternGraph& graph, const Numbers& order, const Numbers& position) {
  const std::int32_t n = graph.vertex_count();
  Numbers parent(at(n), -1), ancestor(at(n), -1);
  for (std::int32_t i = 0; i < n; ++i)
    for (const std::int32_t neighbor : graph.neighbors(order[at(i)])) {
      std::int32_t k = position[at(neighbor)];
      while (k < i && k != -1) {  // Up to i, with path compression.
        const std::int32_t next = ancestor[at(k)];
        ancestor[at(k)] = i;
        if (next == -1) parent[at(k)] = i;
        if (next == i) break;
        k = next;
      }
    }
  return parent;
}

/// Lists of children in ascending order; the last list has the roots.
struct Children {
  Numbers start, list;
  explicit Children(const Numbers& parent) : start(parent.size() + 2, 0), list(parent.size()) {
    const auto n = std::int32_t(parent.size());
    const auto slot = [&](std::int32_t i) { return parent[at(i)] < 0 ? n : parent[at(i)]; };
    for (std::int32_t i = 0; i < n; ++i) ++start[at(slot(i)) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    Numbers next = start;
    for (std::int32_t i = 0; i < n; ++i) list[at(next[at(slot(i))]++)] = i;
  }
  [[nodiscard]] std::span<std::int32_t> of(std::int32_t i) {
    return std::span(list).subspan(at(start[at(i)]), at(start[at(i) + 1] - start[at(i)]));
  }
  [[nodiscard]] std::span<std::int32_t> roots() { return of(std::int32_t(start.size()) - 2); }
};

/// Vertices of a forest in postorder: children before parents, subtrees contiguous.
Numbers postorder(Children& children) {
  Numbers order, stack(children.roots().rbegin(), children.roots().rend());
  order.reserve(children.list.size());
  while (!stack.empty()) {
    // A vertex is at the top twice: the first time it is marked and its children are pushed.
    const std::int32_t top = stack.back();
    if (top < 0) {
      order.push_back(~top);
      stack.pop_back();
      continue;
    }
    stack.back() = ~top;
    const auto list = children.of(top);
    stack.insert(stack.end(), list.rbegin(), list.rend());
  }
  return order;
}

Numbers inverse(const Numbers& order) {
  Numbers position(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) position[at(order[k])] = std::int32_t(k);
  return position;
}

/// The forest of `parent`, its vertices renumbered by their position in `order`.
Numbers renumbered(const Numbers& parent, const Numbers& order) {
  const Numbers position = inverse(order);
  Numbers renamed(parent.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::int32_t p = parent[at(order[k])];
    renamed[k] = p < 0 ? -1 : position[at(p)];
  }
  return renamed;
}

/// Numbers of vertices and rows below the diagonal in each column of the factor.
struct ColumnCounts {
  Numbers vertices, rows;
};

ColumnCounts count_columns(const PatternGraph& graph, const Numbers& order, const Numbers& parent) {
  const std::int32_t n = graph.vertex_count();
  const Numbers position = inverse(order);
  ColumnCounts counts{Numbers(at(n), 0), Numbers(at(n), 0)};
  Numbers mark(at(n), -1);
  for (std::int32_t i = 0; i < n; ++i) {
    // Row i of the factor: all vertices on the tree paths from its entries in A to i.
    mark[at(i)] = i;
    for (const std::int32_t neighbor : graph.neighbors(order[at(i)]))
      for (std::int32_t k = position[at(neighbor)]; k < i && mark[at(k)] != i; k = parent[at(k)]) {
        mark[at(k)] = i;
        ++counts.vertices[at(k)];
        counts.rows[at(k)] += graph.rows(order[at(i)]);
      }
  }
  return counts;
}

/// A supernode before it gets its final number.
struct Draft {
  std::int32_t parent = -1;
  std::int32_t own = 0;    ///< Rows.
  std::int32_t below = 0;  ///< Rows.
  double entries = 0.0;    ///< Entries of its columns that are not known to be zero.
  Numbers vertices;        ///< Positions in the order.
};

double stored(double own, double below) { return own * (own + 1.0) / 2.0 + own * below; }

/// Supernodes of columns with the same pattern below the diagonal.
std::vector<Draft> fundamental_supernodes(const PatternGraph& graph, const Numbers& order,
                                          const Numbers& parent, const ColumnCounts& counts) {
  const auto n = std::int32_t(parent.size());
  std::vector<Draft> drafts;
  Numbers draft_of(at(n));
  for (std::int32_t i = 0; i < n; ++i) {
    const bool joins =
        i > 0 && parent[at(i) - 1] == i && counts.vertices[at(i) - 1] == counts.vertices[at(i)] + 1;
    if (!joins) drafts.emplace_back();
    draft_of[at(i)] = std::int32_t(drafts.size()) - 1;
    Draft& draft = drafts.back();
    draft.vertices.push_back(i);
    draft.own += graph.rows(order[at(i)]);
    draft.below = counts.rows[at(i)];
  }
  for (Draft& draft : drafts) {
    const std::int32_t up = parent[at(draft.vertices.back())];
    draft.parent = up < 0 ? -1 : draft_of[at(up)];
    draft.entries = stored(draft.own, draft.below);
  }
  return drafts;
}

/// True if a merged supernode with so many own rows may contain this fraction of zeros. Small
/// supernodes are faster as one block with zeros than as several without. Measured on blocks of
/// hexahedra and tetrahedra.
bool worth_merging(double own, double zeros) {
  if (own <= 24) return true;
  if (own <= 48) return zeros < 0.4;
  if (own <= kTile) return zeros < 0.15;
  return zeros < 0.05;
}

/// Merges supernodes with their parents while this adds few zeros (\cite ashcraft1989).
std::vector<Draft> merge_supernodes(std::vector<Draft> drafts) {
  const auto n = std::int32_t(drafts.size());
  std::vector<Numbers> children(at(n));
  std::vector<char> is_gone(at(n), 0);
  for (std::int32_t s = 0; s < n; ++s) {
    Draft& draft = drafts[at(s)];
    const auto merged_size = [&](std::int32_t c) {
      return stored(drafts[at(c)].own + draft.own, draft.below);
    };
    const auto zeros_added = [&](std::int32_t c) {
      return merged_size(c) - drafts[at(c)].entries - draft.entries;
    };
    Numbers candidates = std::exchange(children[at(s)], {});
    std::vector<std::pair<double, std::int32_t>> by_zeros;
    for (const std::int32_t c : candidates) by_zeros.emplace_back(zeros_added(c), c);
    std::sort(by_zeros.begin(), by_zeros.end());
    for (const auto& [zeros, c] : by_zeros) {
      Draft& child = drafts[at(c)];
      if (!worth_merging(child.own + draft.own, zeros_added(c) / merged_size(c))) {
        children[at(s)].push_back(c);
        continue;
      }
      draft.own += child.own;
      draft.entries += child.entries;
      draft.vertices.insert(draft.vertices.end(), child.vertices.begin(), child.vertices.end());
      for (const std::int32_t grandchild : children[at(c)]) {
        drafts[at(grandchild)].parent = s;
        children[at(s)].push_back(grandchild);
      }
      is_gone[at(c)] = 1;
      child = {};
    }
    if (draft.parent >= 0) children[at(draft.parent)].push_back(s);
  }

  Numbers new_number(at(n), -1);
  std::vector<Draft> kept;
  for (std::int32_t s = 0; s < n; ++s) {
    if (is_gone[at(s)] != 0) continue;
    new_number[at(s)] = std::int32_t(kept.size());
    kept.push_back(std::move(drafts[at(s)]));
  }
  for (Draft& draft : kept) {
    if (draft.parent >= 0) draft.parent = new_number[at(draft.parent)];
    std::sort(draft.vertices.begin(), draft.vertices.end());
  }
  return kept;
}

std::int64_t update_size(const Draft& draft) {
  return TileLayout(padded(draft.below), 0).entry_count();
}

/// Orders children so that the memory for waiting update matrices is small (\cite liu1986): by
/// descending difference between the peak of the subtree and its update matrix. All in postorder.
///
/// \returns the drafts in that order, and the peak size of waiting update matrices.
std::pair<std::vector<Draft>, std::int64_t> ordered_supernodes(std::vector<Draft> drafts) {
  const auto n = std::int32_t(drafts.size());
  Numbers parent;
  for (const Draft& draft : drafts) parent.push_back(draft.parent);
  Children children(parent);
  std::vector<std::int64_t> peak(at(n), 0);
  const auto order_and_peak = [&](std::span<std::int32_t> list, std::int64_t own_update) {
    std::stable_sort(list.begin(), list.end(), [&](std::int32_t a, std::int32_t b) {
      return peak[at(a)] - update_size(drafts[at(a)]) > peak[at(b)] - update_size(drafts[at(b)]);
    });
    std::int64_t waiting = 0, maximum = 0;
    for (const std::int32_t c : list) {
      maximum = std::max(maximum, waiting + peak[at(c)]);
      waiting += update_size(drafts[at(c)]);
    }
    return std::max(maximum, waiting + own_update);
  };
  for (std::int32_t s = 0; s < n; ++s)  // Children have smaller numbers.
    peak[at(s)] = order_and_peak(children.of(s), update_size(drafts[at(s)]));
  const std::int64_t maximum = order_and_peak(children.roots(), 0);

  const Numbers order = postorder(children);
  const Numbers renamed = renumbered(parent, order);
  std::vector<Draft> ordered;
  for (std::size_t k = 0; k < order.size(); ++k) {
    ordered.push_back(std::move(drafts[at(order[k])]));
    ordered.back().parent = renamed[k];
  }
  return {std::move(ordered), maximum};
}

/// Writes the plan, supernode by supernode.
class PlanWriter {
 public:
  PlanWriter(const SparseMatrix& A, const PatternGraph& graph, const Numbers& order,
             std::vector<Draft> drafts, CholeskyPlan& plan)
      : A_(A), graph_(graph), drafts_(std::move(drafts)), plan_(plan) {
    lay_out_rows(order);
    sort_entries();
  }

  void write() {
    const auto n = std::int32_t(drafts_.size());
    Numbers parent;
    for (const Draft& draft : drafts_) parent.push_back(draft.parent);
    Children children(parent);
    front_row_.assign(at(graph_.vertex_count()), 0);
    below_.resize(at(n));
    plan_.child_start.push_back(0);
    plan_.entry_start.push_back(0);
    // Runs are found with the parent, but stored in the order of the children.
    std::vector<std::vector<RowRun>> runs(at(n));
    for (std::int32_t s = 0; s < n; ++s) {
      gather_below(s, children.of(s));
      add_supernode(s, children.of(s));
      number_front(s);
      for (const std::int32_t c : children.of(s)) {
        runs[at(c)] = find_runs(c);
        below_[at(c)] = {};
      }
      place_entries(s);
    }
    const auto roots = children.roots();
    plan_.children.insert(plan_.children.end(), roots.begin(), roots.end());
    plan_.child_start.push_back(std::int32_t(plan_.children.size()));
    plan_.run_start.push_back(0);
    for (const auto& list : runs) {
      plan_.runs.insert(plan_.runs.end(), list.begin(), list.end());
      plan_.run_start.push_back(std::int64_t(plan_.runs.size()));
    }
  }

 private:
  /// Renumbers vertices and rows by supernode.
  void lay_out_rows(const Numbers& order) {
    for (std::int32_t s = 0; s < std::int32_t(drafts_.size()); ++s) {
      first_vertex_.push_back(std::int32_t(vertex_.size()));
      for (const std::int32_t k : drafts_[at(s)].vertices) {
        vertex_.push_back(order[at(k)]);
        supernode_of_.push_back(s);
        for (std::int32_t r = 0; r < graph_.rows(vertex_.back()); ++r)
          plan_.order.push_back(graph_.first_row[at(vertex_.back())] + r);
      }
    }
    first_vertex_.push_back(std::int32_t(vertex_.size()));
    position_ = inverse(vertex_);
    vertex_of_row_.resize(at(graph_.first_row.back()));
    for (std::int32_t v = 0; v < graph_.vertex_count(); ++v)
      for (std::int32_t r = graph_.first_row[at(v)]; r < graph_.first_row[at(v) + 1]; ++r)
        vertex_of_row_[at(r)] = v;
  }

  /// Lists the entries of A by the supernode that assembles them.
  void sort_entries() {
    const auto visit = [&](const auto& body) {
      for (std::int32_t j = 0; j < A_.cols(); ++j)
        for (int k = A_.outerIndexPtr()[j]; k < A_.outerIndexPtr()[j + 1]; ++k) {
          const std::int32_t i = A_.innerIndexPtr()[k];
          const std::int32_t column =
              std::min(position_[at(vertex_of_row_[at(i)])], position_[at(vertex_of_row_[at(j)])]);
          body(supernode_of_[at(column)], k, j);
        }
    };
    entry_begin_.assign(drafts_.size() + 1, 0);
    visit([&](std::int32_t s, int, std::int32_t) { ++entry_begin_[at(s) + 1]; });
    std::partial_sum(entry_begin_.begin(), entry_begin_.end(), entry_begin_.begin());
    std::vector<std::int64_t> next = entry_begin_;
    entry_.resize(std::size_t(A_.nonZeros()));
    visit([&](std::int32_t s, int k, std::int32_t j) {
      entry_[std::size_t(next[at(s)]++)] = {k, j};
    });
  }

  /// Collects the vertices below a supernode, in ascending order.
  void gather_below(std::int32_t s, std::span<const std::int32_t> children) {
    const std::int32_t end = first_vertex_[at(s) + 1];
    Numbers& below = below_[at(s)];
    const auto add = [&](std::int32_t v) {
      if (v < end || front_row_[at(v)] == ~s) return;
      front_row_[at(v)] = ~s;  // Marks v as visited by s; rows are not negative.
      below.push_back(v);
    };
    for (std::int32_t v = first_vertex_[at(s)]; v < end; ++v)
      for (const std::int32_t u : graph_.neighbors(vertex_[at(v)])) add(position_[at(u)]);
    for (const std::int32_t c : children)
      for (const std::int32_t v : below_[at(c)]) add(v);
    std::sort(below.begin(), below.end());
  }

  void add_supernode(std::int32_t s, std::span<const std::int32_t> children) {
    const Draft& draft = drafts_[at(s)];
    Supernode node;
    node.own = draft.own;
    for (const std::int32_t v : below_[at(s)]) node.below += graph_.rows(vertex_[at(v)]);
    LEFORT_CHECK(node.below == draft.below);
    node.parent = draft.parent;
    node.first_descendant = s;
    if (s > 0) {
      const Supernode& before = plan_.supernodes.back();
      node.first_row = before.first_row + before.own;
    }
    const double own = node.own, below = node.below;
    node.work = own * own * own / 6.0 + own * own * below / 2.0 + own * below * below / 2.0;
    for (const std::int32_t c : children) {
      node.work += plan_.supernodes[at(c)].work;
      node.first_descendant =
          std::min(node.first_descendant, plan_.supernodes[at(c)].first_descendant);
      plan_.children.push_back(c);
    }
    plan_.child_start.push_back(std::int32_t(plan_.children.size()));
    node.panel = plan_.factor_entries;
    plan_.factor_entries += node.panel_layout().entry_count();
    node.rows_offset = plan_.front_rows;
    plan_.front_rows += node.panel_layout().rows();
    plan_.supernodes.push_back(node);
  }

  /// Sets the first row of each vertex of the front.
  void number_front(std::int32_t s) {
    std::int32_t row = 0;
    for (std::int32_t v = first_vertex_[at(s)]; v < first_vertex_[at(s) + 1]; ++v) {
      front_row_[at(v)] = row;
      row += graph_.rows(vertex_[at(v)]);
    }
    row = padded(row);
    for (const std::int32_t v : below_[at(s)]) {
      front_row_[at(v)] = row;
      row += graph_.rows(vertex_[at(v)]);
    }
  }

  /// Finds where the rows below a child are in the front that was numbered last.
  std::vector<RowRun> find_runs(std::int32_t child) {
    const TileLayout layout = plan_.supernodes[at(drafts_[at(child)].parent)].panel_layout();
    std::vector<RowRun> runs;
    std::int32_t row = 0;
    for (const std::int32_t v : below_[at(child)])
      for (std::int32_t r = 0; r < graph_.rows(vertex_[at(v)]); ++r, ++row) {
        const std::int32_t parent_row = front_row_[at(v)] + r;
        const bool continues =
            !runs.empty() && runs.back().parent_row + runs.back().count == parent_row &&
            row % kTile != 0 && layout.tile_of(parent_row) == layout.tile_of(parent_row - 1);
        if (continues)
          ++runs.back().count;
        else
          runs.push_back({row, parent_row, 1});
      }
    return runs;
  }

  /// Finds the positions of the entries of A in the front that was numbered last.
  void place_entries(std::int32_t s) {
    const TileLayout layout = plan_.supernodes[at(s)].panel_layout();
    for (std::int64_t e = entry_begin_[at(s)]; e < entry_begin_[at(s) + 1]; ++e) {
      const auto [k, column] = entry_[std::size_t(e)];
      const auto row_in_front = [&](std::int32_t row) {
        const std::int32_t v = vertex_of_row_[at(row)];
        return front_row_[at(position_[at(v)])] + row - graph_.first_row[at(v)];
      };
      const std::int32_t a = row_in_front(A_.innerIndexPtr()[k]), b = row_in_front(column);
      const std::int32_t i = std::max(a, b), j = std::min(a, b);
      const int tile_i = layout.tile_of(i), tile_j = layout.tile_of(j);
      const std::int64_t offset = layout.offset(tile_i, tile_j) +
                                  std::int64_t(j - layout.start(tile_j)) * layout.size(tile_i) + i -
                                  layout.start(tile_i);
      if (offset > std::numeric_limits<std::uint32_t>::max()) throw std::bad_alloc();
      plan_.entries.push_back({k, std::uint32_t(offset)});
    }
    plan_.entry_start.push_back(std::int64_t(plan_.entries.size()));
  }

  struct Entry {
    std::int32_t k, column;
  };

  const SparseMatrix& A_;
  const PatternGraph& graph_;
  std::vector<Draft> drafts_;
  CholeskyPlan& plan_;
  Numbers vertex_;         ///< Vertex of the graph, by position in the elimination order.
  Numbers position_;       ///< The inverse.
  Numbers supernode_of_;   ///< By position, as are front_row_ and below_.
  Numbers first_vertex_;   ///< Of each supernode; at the end the number of vertices.
  Numbers vertex_of_row_;  ///< Vertex of the graph, by row of A.
  Numbers front_row_;
  std::vector<Numbers> below_;
  std::vector<std::int64_t> entry_begin_;
  std::vector<Entry> entry_;
};

CholeskyPlan plan_in_order(const SparseMatrix& A, const PatternGraph& graph, Numbers order) {
  {
    const Numbers tree = elimination_tree(graph, order, inverse(order));
    Children children(tree);
    Numbers postordered;
    for (const std::int32_t k : postorder(children)) postordered.push_back(order[at(k)]);
    order = std::move(postordered);
  }
  const Numbers tree = elimination_tree(graph, order, inverse(order));
  std::vector<Draft> drafts = merge_supernodes(
      fundamental_supernodes(graph, order, tree, count_columns(graph, order, tree)));
  auto [ordered, peak] = ordered_supernodes(std::move(drafts));
  CholeskyPlan plan;
  plan.peak_update = peak;
  PlanWriter(A, graph, order, std::move(ordered), plan).write();
  return plan;
}

}  // namespace

double CholeskyPlan::work() const {
  double sum = 0.0;
  for (const Supernode& node : supernodes)
    if (node.parent < 0) sum += node.work;
  return sum;
}

std::optional<CholeskyPlan> plan_cholesky(const SparseMatrix& A) try {
  const PatternGraph graph = pattern_graph(A);
  std::optional<Numbers> order = dissection_order(graph);
  if (!order) return std::nullopt;
  return plan_in_order(A, graph, *std::move(order));
} catch (const std::bad_alloc&) {
  return std::nullopt;
}

}  // namespace lefort::linear
