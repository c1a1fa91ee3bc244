#include <lefort/anatomy/partial_volume_air.h>

#include <algorithm>
#include <cstdlib>

namespace lefort::anatomy {
namespace {

constexpr double kAir_hu = -1000.0;

}  // namespace

Mask partial_volume_air(const image::CtVolume& ct, const Mask& air, const Mask& bone) {
  LEFORT_CHECK(air.grid == ct.grid && bone.grid == ct.grid);
  const auto& size = ct.grid.size;
  Mask found = mask_where(ct.grid, [](std::size_t) { return false; });
  const auto is_air_at = [&](Index i, Index j, Index k) {
    bool touches_air = false;
    double densest_hu = kAir_hu;
    for (Index c = std::max<Index>(k - 1, 0); c <= std::min(k + 1, size[2] - 1); ++c)
      for (Index b = std::max<Index>(j - 1, 0); b <= std::min(j + 1, size[1] - 1); ++b)
        for (Index a = std::max<Index>(i - 1, 0); a <= std::min(i + 1, size[0] - 1); ++a) {
          const bool shares_face = std::abs(a - i) + std::abs(b - j) + std::abs(c - k) == 1;
          touches_air |= shares_face && air.at(a, b, c) != 0;
          if (bone.at(a, b, c) != 0) densest_hu = std::max(densest_hu, double(ct.at(a, b, c)));
        }
    return touches_air && double(ct.at(i, j, k)) < 0.5 * (kAir_hu + densest_hu);
  };
  parallel_for(size[1] * size[2], [&](Index line) {
    const Index j = line % size[1], k = line / size[1];
    for (Index i = 0; i < size[0]; ++i)
      if (air.at(i, j, k) == 0 && bone.at(i, j, k) == 0)
        found.at(i, j, k) = is_air_at(i, j, k) ? 1 : 0;
  });
  return found;
}

}  // namespace lefort::anatomy
