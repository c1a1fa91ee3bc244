#include <lefort/field/build/nearest_by_tree.h>
#include <lefort/field/internal/tile_kernel.h>

#include <utility>

namespace lefort::field {

namespace {

using namespace internal;

static_assert(TriangleTree::kLeafTriangles == kBatch);

/// Cache of prepared leaves: tiles of a brick mostly visit the same ones.
struct PreparedLeaves {
  static constexpr std::size_t kSlots = 64;
  std::array<std::int32_t, kSlots> leaf;
  alignas(64) std::array<Batch, kSlots> planes;

  PreparedLeaves() { leaf.fill(-1); }
};

/// Sixteen points, relative to the origin of the tree.
struct Tile {
  Floats x, y, z;
};

/// Squared distances of the points from a box.
LEFORT_INLINE Floats squared_to_box(const TriangleTree::Node& box, const Tile& tile) {
  const Floats x = larger(larger(box.low[0] - tile.x, tile.x - box.high[0]), Floats{});
  const Floats y = larger(larger(box.low[1] - tile.y, tile.y - box.high[1]), Floats{});
  const Floats z = larger(larger(box.low[2] - tile.z, tile.z - box.high[2]), Floats{});
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

template <Simd simd>
LEFORT_INLINE void find_all(const geometry::TriangleMesh& mesh, const TriangleTree& tree,
                            const Vec3& low, double cell, double max_distance_mm,
                            NearestInBrick& nearest) {
  constexpr int kTileX = int(NearestInBrick::kTileX), kTileY = int(NearestInBrick::kTileY),
                kTileZ = int(NearestInBrick::kTileZ);
  PreparedLeaves prepared;
  const auto step = float(cell);
  const Vec3 from_origin = low - tree.origin;
  const std::array<float, 3> first = {float(from_origin[0]), float(from_origin[1]),
                                      float(from_origin[2])};
  std::array<std::int32_t, TriangleTree::kStackSize> stack;
  for (int z = 0; z < kSide; z += kTileZ)
    for (int y = 0; y < kSide; y += kTileY)
      for (int x = 0; x < kSide; x += kTileX) {
        const std::size_t offset = NearestInBrick::linear_offset(x, y, z);
        const auto& known = *reinterpret_cast<const Floats*>(&nearest.squared_mm2[offset]);
        if (!any(*reinterpret_cast<const Ints*>(&nearest.code[offset]) < Ints{})) continue;
        const Tile tile = {first[0] + step * (float(x) + kTileX_cells),
                           first[1] + step * (float(y) + kTileY_cells),
                           first[2] + step * (float(z) + kTileZ_cells)};
        const std::array<float, 3> middle = {first[0] + step * (float(x) + 1.5F),
                                             first[1] + step * (float(y) + 0.5F),
                                             first[2] + step * (float(z) + 0.5F)};
        std::size_t depth = 0;
        stack[depth++] = 0;
        while (depth > 0) {
          const std::int32_t n = stack[--depth];
          const TriangleTree::Node& node = tree.nodes[std::size_t(n)];
          if (!any_less<simd>(squared_to_box(node, tile), known)) continue;
          if (node.count == 0) {
            std::pair children(n + 1, node.first);
            if (squared_to_box(tree.nodes[std::size_t(children.second)], middle) <
                squared_to_box(tree.nodes[std::size_t(children.first)], middle))
              std::swap(children.first, children.second);
            stack[depth++] = children.second;
            stack[depth++] = children.first;
            continue;
          }
          const std::span triangles(tree.order.data() + node.first, std::size_t(node.count));
          const std::size_t slot = std::size_t(n) % PreparedLeaves::kSlots;
          Batch& batch = prepared.planes[slot];
          if (std::exchange(prepared.leaf[slot], n) != n)
            prepare_triangles(mesh, triangles, low, cell, max_distance_mm, batch);
          for (std::size_t l = 0; l < triangles.size(); ++l) {
            const Planes& planes = batch[l];
            const Quantities here = planes.at_low + planes.step[1] * float(y) +
                                    planes.step[2] * float(z) + planes.step[0] * float(x);
            const auto quantity = [&](std::size_t q) __attribute__((always_inline)) {
              return within_tile(planes, q) + here[q];
            };
            visit_tile<simd>(planes, quantity, triangles[l], offset, nearest);
          }
        }
      }
}

#if defined(__x86_64__)
LEFORT_AVX512 void find_avx512(const geometry::TriangleMesh& mesh, const TriangleTree& tree,
                               const Vec3& low, double cell, double max_distance_mm,
                               NearestInBrick& nearest) {
  find_all<Simd::kAvx512>(mesh, tree, low, cell, max_distance_mm, nearest);
}

LEFORT_AVX2 void find_avx2(const geometry::TriangleMesh& mesh, const TriangleTree& tree,
                           const Vec3& low, double cell, double max_distance_mm,
                           NearestInBrick& nearest) {
  find_all<Simd::kAvx2>(mesh, tree, low, cell, max_distance_mm, nearest);
}
#endif

}  // namespace

void find_nearest(const geometry::TriangleMesh& mesh, const TriangleTree& tree, const Vec3& low,
                  double cell, double max_distance_mm, Simd simd, NearestInBrick& nearest) {
#if defined(__x86_64__)
  if (simd == Simd::kAvx512) return find_avx512(mesh, tree, low, cell, max_distance_mm, nearest);
  if (simd == Simd::kAvx2) return find_avx2(mesh, tree, low, cell, max_distance_mm, nearest);
#endif
  find_all<Simd::kBaseline>(mesh, tree, low, cell, max_distance_mm, nearest);
}

}  // namespace lefort::field
