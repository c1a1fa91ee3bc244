#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/assembly/assembly_plan.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace lefort::fem {
namespace {

/// Doubles in the stiffness buffer of one chunk: 2 MB, which fits into the cache of a processor.
/// The value affects the last bits of results: sums are computed chunk by chunk.
constexpr Index kChunkDoubles = Index(1) << 18;

std::vector<Chunk> cut_into_chunks(std::span<const ForceTerm* const> terms, Index node_count) {
  std::vector<Chunk> chunks;
  Index forces = 0;
  Index stiffness = kChunkDoubles;  // Full: the first item opens a chunk.
  for (std::size_t t = 0; t < terms.size(); ++t) {
    LEFORT_CHECK(terms[t] != nullptr);
    LEFORT_CHECK(terms[t]->item_count() <= std::numeric_limits<std::int32_t>::max());
    for (Index item = 0; item < terms[t]->item_count(); ++item) {
      const std::span<const std::int32_t> nodes = terms[t]->nodes(item);
      LEFORT_CHECK(!nodes.empty() && nodes.size() <= std::size_t(kMaxLocalNodes));
      for (const std::int32_t node : nodes) LEFORT_CHECK(node >= 0 && node < node_count);
      const Index size = 3 * Index(nodes.size());
      if (stiffness + size * size > kChunkDoubles) {
        chunks.emplace_back();
        forces = stiffness = 0;
      }
      chunks.back().items.push_back(
          {std::int32_t(t), std::int32_t(item), std::int32_t(forces), std::int32_t(stiffness)});
      forces += size;
      stiffness += size * size;
    }
  }
  return chunks;
}

/// \returns a pair of nodes as one number that sorts by column, then row.
std::uint64_t pair_key(std::int32_t row, std::int32_t column) {
  return (std::uint64_t(std::uint32_t(column)) << 32) | std::uint32_t(row);
}

void sort_and_unique(std::vector<std::uint64_t>& keys) {
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

/// \returns all coupled pairs; every node is coupled with itself.
std::vector<std::uint64_t> coupled_pairs(const std::vector<Chunk>& chunks,
                                         std::span<const ForceTerm* const> terms,
                                         Index node_count) {
  std::vector<std::vector<std::uint64_t>> of_chunk(chunks.size());
  parallel_for(
      Index(chunks.size()),
      [&](Index c) {
        std::vector<std::uint64_t>& keys = of_chunk[std::size_t(c)];
        for (const PlannedItem& planned : chunks[std::size_t(c)].items) {
          const auto nodes = terms[std::size_t(planned.term)]->nodes(planned.item);
          for (const std::int32_t row : nodes)
            for (const std::int32_t column : nodes)
              if (row >= column) keys.push_back(pair_key(row, column));
        }
        sort_and_unique(keys);
      },
      1);
  std::vector<std::uint64_t> all;
  for (Index node = 0; node < node_count; ++node)
    all.push_back(pair_key(std::int32_t(node), std::int32_t(node)));
  for (const auto& keys : of_chunk) all.insert(all.end(), keys.begin(), keys.end());
  sort_and_unique(all);
  return all;
}

/// Groups (target, source) pairs by target, in their order.
template <class Source>
Gather<Source> gather_by_target(std::vector<std::pair<std::int32_t, Source>> pairs) {
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Gather<Source> gather;
  for (const auto& [target, source] : pairs) {
    if (gather.target.empty() || gather.target.back() != target) {
      gather.target.push_back(target);
      gather.first.push_back(std::int32_t(gather.source.size()));
    }
    gather.source.push_back(source);
  }
  gather.first.push_back(std::int32_t(gather.source.size()));
  return gather;
}

void lay_out_gathers(Chunk& chunk, std::span<const ForceTerm* const> terms,
                     const std::vector<std::uint64_t>& pairs) {
  std::vector<std::pair<std::int32_t, std::int32_t>> forces;
  std::vector<std::pair<std::int32_t, BlockSource>> stiffness;
  for (const PlannedItem& planned : chunk.items) {
    const auto nodes = terms[std::size_t(planned.term)]->nodes(planned.item);
    const auto stride = std::int32_t(3 * nodes.size());
    for (std::size_t b = 0; b < nodes.size(); ++b) {
      forces.emplace_back(nodes[b], planned.forces + std::int32_t(3 * b));
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        if (nodes[a] < nodes[b]) continue;
        LEFORT_CHECK(a == b || nodes[a] != nodes[b]);  // The nodes of an item differ.
        const auto pair =
            std::lower_bound(pairs.begin(), pairs.end(), pair_key(nodes[a], nodes[b]));
        const std::int32_t offset =
            planned.stiffness + std::int32_t(3 * b) * stride + std::int32_t(3 * a);
        stiffness.emplace_back(std::int32_t(pair - pairs.begin()), BlockSource{offset, stride});
      }
    }
  }
  chunk.forces = gather_by_target(std::move(forces));
  chunk.stiffness = gather_by_target(std::move(stiffness));
}

/// Numbers the blocks in the values of the matrix and builds its pattern.
void lay_out_tangent(const DofMap& dofs, AssemblyPlan& plan) {
  std::vector<int> starts{0};
  std::vector<int> rows;
  for (std::size_t begin = 0, end = 0; begin < plan.blocks.size(); begin = end) {
    const std::int32_t column_node = plan.blocks[begin].column_node;
    while (end < plan.blocks.size() && plan.blocks[end].column_node == column_node) ++end;
    for (int c = 0; c < 3; ++c) {
      if (dofs.free_number(3 * Index(column_node) + c) < 0) continue;
      for (std::size_t k = begin; k < end; ++k) {
        TangentBlock& block = plan.blocks[k];
        LEFORT_CHECK(rows.size() < std::size_t(std::numeric_limits<std::int32_t>::max() - 3));
        block.value_index[std::size_t(c)] = std::int32_t(rows.size());
        for (int r = k == begin ? c : 0; r < 3; ++r) {
          const std::int32_t row = dofs.free_number(3 * Index(block.row_node) + r);
          if (row >= 0) rows.push_back(row);
        }
      }
      starts.push_back(int(rows.size()));
    }
  }
  const std::vector<double> zeros(rows.size(), 0.0);
  plan.pattern = Eigen::Map<const linear::SparseMatrix>(dofs.free_count(), dofs.free_count(),
                                                        Index(rows.size()), starts.data(),
                                                        rows.data(), zeros.data());
}

}  // namespace

AssemblyPlan plan_assembly(const DofMap& dofs, std::span<const ForceTerm* const> terms) {
  AssemblyPlan plan;
  plan.chunks = cut_into_chunks(terms, dofs.node_count());
  const auto pairs = coupled_pairs(plan.chunks, terms, dofs.node_count());
  LEFORT_CHECK(pairs.size() < std::size_t(std::numeric_limits<std::int32_t>::max()));
  plan.blocks.reserve(pairs.size());
  for (const std::uint64_t key : pairs)
    plan.blocks.push_back({.row_node = std::int32_t(key & 0xffffffffU),
                           .column_node = std::int32_t(key >> 32),
                           .value_index = {-1, -1, -1}});
  lay_out_tangent(dofs, plan);

  parallel_for(
      Index(plan.chunks.size()),
      [&](Index c) { lay_out_gathers(plan.chunks[std::size_t(c)], terms, pairs); }, 1);
  for (const Chunk& chunk : plan.chunks) {
    const PlannedItem& last = chunk.items.back();
    const auto size = Index(3 * terms[std::size_t(last.term)]->nodes(last.item).size());
    plan.force_buffer_size = std::max(plan.force_buffer_size, last.forces + size);
    plan.stiffness_buffer_size = std::max(plan.stiffness_buffer_size, last.stiffness + size * size);
  }
  return plan;
}

}  // namespace lefort::fem
