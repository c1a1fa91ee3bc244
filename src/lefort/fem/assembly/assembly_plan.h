/// \file
/// Layout of the assembly: where each entry of each local vector and matrix is added. It is
/// computed once and used by every assembly.
///
/// Items are divided into chunks whose local matrices fit into a buffer of the size of the
/// processor cache. A chunk is first evaluated (each item writes its own part of the buffer), then
/// gathered (each task owns its targets and adds their sources in the order of items). So no two
/// tasks write to one target, and no sum depends on the order of tasks.
///
///     items      0  1  2  3 | 4  5  6 | ...        chunks, by size alone
///     buffer    [....local matrices...]            reused by every chunk
///     gather     block (i, j) of the tangent <- 3x3 blocks of the buffer, in order
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/linear/sparse_matrix.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::fem {

/// One local item of one term, with its offsets in the buffers.
struct PlannedItem {
  std::int32_t term;
  std::int32_t item;
  std::int32_t forces;     ///< Offset of its residual in the chunk's force buffer.
  std::int32_t stiffness;  ///< Offset of its matrix in the chunk's stiffness buffer.
};

/// A 3x3 block of the buffer: its first entry, and the distance between its columns.
struct BlockSource {
  std::int32_t offset;
  std::int32_t stride;
};

/// Lists of sources, one per target: those of target[k] are source[first[k]] to
/// source[first[k + 1] - 1].
template <class Source>
struct Gather {
  std::vector<std::int32_t> target;
  std::vector<std::int32_t> first;
  std::vector<Source> source;
};

/// Items that are evaluated, then gathered, together.
struct Chunk {
  std::vector<PlannedItem> items;
  Gather<std::int32_t> forces;    ///< Node <- offsets into the force buffer.
  Gather<BlockSource> stiffness;  ///< Block of the tangent <- blocks of the stiffness buffer.
};

/// One coupled pair of nodes, row >= column, with its position in the tangent of free components.
struct TangentBlock {
  std::int32_t row_node;
  std::int32_t column_node;
  /// Per component c of column_node: position, among the values of the matrix, of the first free
  /// component of row_node; if row_node == column_node, of the first one >= c. -1 if c is not free.
  std::array<std::int32_t, 3> value_index;
};

/// Layout of chunks and tangent.
struct AssemblyPlan {
  std::vector<Chunk> chunks;
  Index force_buffer_size = 0;
  Index stiffness_buffer_size = 0;
  std::vector<TangentBlock> blocks;  ///< By column, then row.
  linear::SparseMatrix pattern;      ///< Lower triangle of the free components, all zero.
};

/// \param dofs   which components are free.
/// \param terms  not null; \pre the nodes of all items exist in `dofs`.
[[nodiscard]] AssemblyPlan plan_assembly(const DofMap& dofs,
                                         std::span<const ForceTerm* const> terms);

}  // namespace lefort::fem
