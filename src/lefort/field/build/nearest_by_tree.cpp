#include <lefort/field/build/nearest_by_tree.h>
#include <lefort/field/internal/tile_kernel.h>

#include <utility>

namespace lefort::field {

namespace {

using internal::Batch;
using internal::Floats;
using internal::Ints;
using internal::kBatch;
using internal::kQuantities;
using internal::kSide;
using internal::kTileX_cells;
using internal::kTileY_cells;
using internal::kTileZ_cells;
using internal::Pack;
using internal::Planes;
using internal::Quantities;

static_assert(TriangleTree::kLeafTriangles == kBatch);

/// Cache of prepared leaves: tiles of a brick mostly visit the same ones.
struct PreparedLeaves {
  static constexpr std::size_t kSlots = 64;
  std::array<std::int32_t, kSlots> leaf;
  alignas(64) std::array<Batch, kSlots> planes;

  PreparedLeaves() { leaf.fill(-1); }
};

/// Sixteen points, relative to the origin of the tree.
template <Simd simd>
struct Tile {
  Floats<simd> x, y, z;
};

/// Squared distances of the points from a box.
template <Simd simd>
LEFORT_INLINE Floats<simd> squared_to_box(const TriangleTree::Node& box, const Tile<simd>& tile) {
  const auto none = Floats<simd>::filled(0.0F);
  const auto x = larger(larger(box.low[0] - tile.x, tile.x - box.high[0]), none);
  const auto y = larger(larger(box.low[1] - tile.y, tile.y - box.high[1]), none);
  const auto z = larger(larger(box.low[2] - tile.z, tile.z - box.high[2]), none);
  return x * x + y * y + z * z;
}

LEFORT_INLINE float squared_to_box(const TriangleTree::Node& box,
                                   const std::array<float, 3>& point) {
  float sum = 0.0F;
  for (std::size_t k = 0; k < 3; ++k) {
    const float off = std::max(std::max(box.low[k] - point[k], point[k] - box.high[k]), 0.0F);
    sum += off * off;
  }
  return sum;
}

/// What is the same for all tiles of a brick.
struct SearchedBrick {
  const geometry::TriangleMesh& mesh;
  const TriangleTree& tree;
  const Vec3& low;
  double cell;
  double max_distance_mm;
};

/// Visits the triangles of leaf `n`.
///
/// \param first  the first point of the tile in the brick.
template <Simd simd>
LEFORT_INLINE void visit_leaf(const SearchedBrick& brick, std::int32_t n,
                              const std::array<int, 3>& first, PreparedLeaves& prepared,
                              NearestInBrick& nearest) {
  using Row = Pack<float, kQuantities, simd>;
  const TriangleTree::Node& node = brick.tree.nodes[std::size_t(n)];
  const std::span triangles(brick.tree.order.data() + node.first, std::size_t(node.count));
  const std::size_t slot = std::size_t(n) % PreparedLeaves::kSlots;
  Batch& batch = prepared.planes[slot];
  if (std::exchange(prepared.leaf[slot], n) != n)
    prepare_triangles<simd>(brick.mesh, triangles, brick.low, brick.cell, brick.max_distance_mm,
                            batch);
  const std::size_t offset = NearestInBrick::linear_offset(first[0], first[1], first[2]);
  for (std::size_t l = 0; l < triangles.size(); ++l) {
    const Planes& planes = batch[l];
    alignas(32) Quantities here;
    (Row::loaded(planes.at_low.data()) + Row::loaded(planes.step[1].data()) * float(first[1]) +
     Row::loaded(planes.step[2].data()) * float(first[2]) +
     Row::loaded(planes.step[0].data()) * float(first[0]))
        .store(here.data());
    const auto quantity = [&](std::size_t q) __attribute__((always_inline)) {
      return within_tile<simd>(planes, q) + here[q];
    };
    visit_tile<simd>(planes, quantity, triangles[l], offset, nearest);
  }
}

/// Updates the nearest triangles of a tile.
template <Simd simd>
LEFORT_INLINE void find_in_tile(const SearchedBrick& brick, const std::array<int, 3>& first,
                                PreparedLeaves& prepared, NearestInBrick& nearest) {
  const std::size_t offset = NearestInBrick::linear_offset(first[0], first[1], first[2]);
  if (!any(Ints<simd>::loaded(&nearest.code[offset]) < Ints<simd>::filled(0))) return;
  const auto step = float(brick.cell);
  const auto at = [&](int k) __attribute__((always_inline)) {
    return float(brick.low[k] - brick.tree.origin[k]);
  };
  const Tile<simd> tile = {
      (Floats<simd>::loaded(kTileX_cells.data()) + float(first[0])) * step + at(0),
      (Floats<simd>::loaded(kTileY_cells.data()) + float(first[1])) * step + at(1),
      (Floats<simd>::loaded(kTileZ_cells.data()) + float(first[2])) * step + at(2)};
  const std::array<float, 3> middle = {at(0) + step * (float(first[0]) + 1.5F),
                                       at(1) + step * (float(first[1]) + 0.5F),
                                       at(2) + step * (float(first[2]) + 0.5F)};
  const std::vector<TriangleTree::Node>& nodes = brick.tree.nodes;
  std::array<std::int32_t, TriangleTree::kStackSize> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::int32_t n = stack[--depth];
    const TriangleTree::Node& node = nodes[std::size_t(n)];
    const auto known = Floats<simd>::loaded(&nearest.squared_mm2[offset]);
    if (!any_less(squared_to_box(node, tile), known)) continue;
    if (node.count > 0) {
      visit_leaf<simd>(brick, n, first, prepared, nearest);
      continue;
    }
    std::pair children(n + 1, node.first);
    if (squared_to_box(nodes[std::size_t(children.second)], middle) <
        squared_to_box(nodes[std::size_t(children.first)], middle))
      std::swap(children.first, children.second);
    stack[depth++] = children.second;
    stack[depth++] = children.first;
  }
}

template <Simd simd>
LEFORT_INLINE void find_all(const SearchedBrick& brick, NearestInBrick& nearest) {
  PreparedLeaves prepared;
  for (int z = 0; z < kSide; z += int(NearestInBrick::kTileZ))
    for (int y = 0; y < kSide; y += int(NearestInBrick::kTileY))
      for (int x = 0; x < kSide; x += int(NearestInBrick::kTileX))
        find_in_tile<simd>(brick, {x, y, z}, prepared, nearest);
}

#if defined(__x86_64__)
LEFORT_AVX512 void find_avx512(const SearchedBrick& brick, NearestInBrick& nearest) {
  find_all<Simd::kAvx512>(brick, nearest);
}

LEFORT_AVX2 void find_avx2(const SearchedBrick& brick, NearestInBrick& nearest) {
  find_all<Simd::kAvx2>(brick, nearest);
}
#endif

}  // namespace

void find_nearest(const geometry::TriangleMesh& mesh, const TriangleTree& tree, const Vec3& low,
                  double cell, double max_distance_mm, Simd simd, NearestInBrick& nearest) {
  const SearchedBrick brick{mesh, tree, low, cell, max_distance_mm};
#if defined(__x86_64__)
  if (simd == Simd::kAvx512) return find_avx512(brick, nearest);
  if (simd == Simd::kAvx2) return find_avx2(brick, nearest);
#endif
  find_all<Simd::kBaseline>(brick, nearest);
}

}  // namespace lefort::field
