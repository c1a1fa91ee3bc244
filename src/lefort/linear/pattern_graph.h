/// \file
/// The pattern of a symmetric matrix as a graph, and its elimination order.
///
/// Adjacent rows with the same pattern form one vertex. For the three displacements of a node this
/// gives the graph of the mesh, with a ninth of the entries of the matrix, and reduces the cost of
/// symbolic operations accordingly.
#pragma once

#include <lefort/linear/sparse_matrix.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lefort::linear {

/// Vertex v represents the rows first_row[v] to first_row[v + 1] - 1, which have the same pattern.
struct PatternGraph {
  std::vector<std::int32_t> first_row = {0};  ///< The last entry is the number of rows.
  /// Neighbors of vertex v are neighbor[start[v]] to neighbor[start[v + 1] - 1].
  std::vector<std::int32_t> start = {0};
  std::vector<std::int32_t> neighbor;  ///< Ascending, without the vertex itself.

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

/// Builds the graph of a matrix.
///
/// \param A  lower triangle with the whole diagonal, compressed, rows ascending.
[[nodiscard]] PatternGraph pattern_graph(const SparseMatrix& A);

/// Nested dissection (METIS; \cite karypis1998). Concurrent calls wait for each other. The order is
/// reproducible unless another part of the program calls rand() during the call. Seeds rand().
///
/// \param graph  from pattern_graph().
/// \returns the vertices in elimination order, or nothing if memory was exhausted.
[[nodiscard]] std::optional<std::vector<std::int32_t>> dissection_order(const PatternGraph& graph);

}  // namespace lefort::linear
