/// \file
/// Rows of a symmetric matrix as a graph, those of one pattern together, and their order.
///
/// The three displacements of a node couple with the same others: as one vertex they make the graph
/// of the mesh, a ninth of the matrix, and everything symbolic is as much cheaper.
#pragma once

#include <lefort/linear/sparse_matrix.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lefort::linear {

/// Vertex v stands for the rows first_row[v] to first_row[v + 1]: consecutive, of one pattern.
struct RowGraph {
  std::vector<std::int32_t> first_row = {0};  ///< And the number of rows.
  std::vector<std::int32_t> start = {0};      ///< Of each vertex in `neighbor`, and its length.
  std::vector<std::int32_t> neighbor;         ///< Without the vertex itself, ascending.

  [[nodiscard]] std::int32_t vertex_count() const { return std::int32_t(first_row.size()) - 1; }
  [[nodiscard]] std::int32_t rows(std::int32_t v) const {
    return first_row[std::size_t(v) + 1] - first_row[std::size_t(v)];
  }
  [[nodiscard]] std::span<const std::int32_t> neighbors(std::int32_t v) const {
    const auto begin = std::size_t(start[std::size_t(v)]),
               end = std::size_t(start[std::size_t(v) + 1]);
    return std::span(neighbor).subspan(begin, end - begin);
  }
};

/// \param A  lower triangle with the whole diagonal, compressed, rows ascending.
[[nodiscard]] RowGraph pattern_graph(const SparseMatrix& A);

/// Nested dissection (METIS; \cite karypis1998). May be called from several threads, which wait for
/// each other; the order is the same each time, unless another part of the program calls rand()
/// meanwhile. Seeds rand().
/// \returns the vertices in the order in which they are to be eliminated; nothing if memory ran
///   out.
[[nodiscard]] std::optional<std::vector<std::int32_t>> dissection_order(const RowGraph& graph);

}  // namespace lefort::linear
