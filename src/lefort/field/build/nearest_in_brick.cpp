#include <lefort/field/build/nearest_in_brick.h>
#include <lefort/field/internal/tile_kernel.h>

namespace lefort::field {

namespace {

using internal::Batch;
using internal::Floats;
using internal::kBatch;
using internal::kQuantities;
using internal::Pack;
using internal::Planes;
using internal::Quantities;

template <Simd simd>
LEFORT_INLINE void visit(const Planes& planes, std::int32_t triangle, NearestInBrick& nearest) {
  constexpr int kTileX = int(NearestInBrick::kTileX), kTileY = int(NearestInBrick::kTileY),
                kTileZ = int(NearestInBrick::kTileZ);
  using Row = Pack<float, kQuantities, simd>;
  Floats<simd> across[kQuantities - 1];
  for (std::size_t n = 0; n + 1 < kQuantities; ++n) across[n] = within_tile<simd>(planes, n);
  const Row at_low = Row::loaded(planes.at_low.data());
  const Row step_x = Row::loaded(planes.step[0].data()),
            step_y = Row::loaded(planes.step[1].data()),
            step_z = Row::loaded(planes.step[2].data());

  for (int z = planes.low[2] & -kTileZ; z < planes.high[2]; z += kTileZ) {
    for (int y = planes.low[1] & -kTileY; y < planes.high[1]; y += kTileY) {
      const Row row = at_low + step_y * float(y) + step_z * float(z);
      for (int x = planes.low[0] & -kTileX; x < planes.high[0]; x += kTileX) {
        alignas(32) Quantities here;
        (row + step_x * float(x)).store(here.data());
        const auto quantity = [&](std::size_t n) __attribute__((always_inline)) {
          return across[n] + here[n];
        };
        visit_tile<simd>(planes, quantity, triangle, NearestInBrick::linear_offset(x, y, z),
                         nearest);
      }
    }
  }
}

template <Simd simd>
LEFORT_INLINE void visit_batch(const geometry::TriangleMesh& mesh,
                               std::span<const std::int32_t> triangles, const Vec3& low,
                               double cell, double max_distance_mm, NearestInBrick& nearest) {
  alignas(64) Batch batch;
  prepare_triangles<simd>(mesh, triangles, low, cell, max_distance_mm, batch);
  for (std::size_t l = 0; l < triangles.size(); ++l) visit<simd>(batch[l], triangles[l], nearest);
}

/// Visits every sixteenth triangle first, then those halfway between, and so on. Consecutive
/// triangles are close to each other; the first few, distributed over the brick, rule out most of
/// the others.
template <Simd simd>
LEFORT_INLINE void visit_all(const geometry::TriangleMesh& mesh,
                             std::span<const std::int32_t> triangles, const Vec3& low, double cell,
                             double max_distance_mm, NearestInBrick& nearest) {
  constexpr std::size_t kFirstStep = 16;
  std::array<std::int32_t, kBatch> chosen;
  std::size_t count = 0;
  for (std::size_t half = kFirstStep; half > 0; half /= 2) {
    const bool is_first = half == kFirstStep;
    for (std::size_t i = is_first ? 0 : half; i < triangles.size();
         i += is_first ? half : 2 * half) {
      chosen[count++] = triangles[i];
      if (count < kBatch) continue;
      visit_batch<simd>(mesh, chosen, low, cell, max_distance_mm, nearest);
      count = 0;
    }
  }
  if (count > 0)
    visit_batch<simd>(mesh, std::span(chosen).first(count), low, cell, max_distance_mm, nearest);
}

#if defined(__x86_64__)
LEFORT_AVX512 void visit_avx512(const geometry::TriangleMesh& mesh,
                                std::span<const std::int32_t> triangles, const Vec3& low,
                                double cell, double max_distance_mm, NearestInBrick& nearest) {
  visit_all<Simd::kAvx512>(mesh, triangles, low, cell, max_distance_mm, nearest);
}

LEFORT_AVX2 void visit_avx2(const geometry::TriangleMesh& mesh,
                            std::span<const std::int32_t> triangles, const Vec3& low, double cell,
                            double max_distance_mm, NearestInBrick& nearest) {
  visit_all<Simd::kAvx2>(mesh, triangles, low, cell, max_distance_mm, nearest);
}
#endif

}  // namespace

void visit_triangles(const geometry::TriangleMesh& mesh, std::span<const std::int32_t> triangles,
                     const Vec3& low, double cell, double max_distance_mm, Simd simd,
                     NearestInBrick& nearest) {
#if defined(__x86_64__)
  if (simd == Simd::kAvx512)
    return visit_avx512(mesh, triangles, low, cell, max_distance_mm, nearest);
  if (simd == Simd::kAvx2) return visit_avx2(mesh, triangles, low, cell, max_distance_mm, nearest);
#endif
  visit_all<Simd::kBaseline>(mesh, triangles, low, cell, max_distance_mm, nearest);
}

}  // namespace lefort::field
