#include <lefort/image/find_padding.h>

#include <array>
#include <cstddef>
#include <vector>

namespace lefort::image {

Padding find_padding(const CtVolume& ct, double tissue_hu) {
  Padding padding;
  const Grid& grid = ct.grid;
  if (ct.values.empty()) return padding;
  padding.hu = ct.at(0, 0, grid.size[2] / 2);
  // The patient extends to the border of the grid.
  if (double(padding.hu) >= tissue_hu) return padding;
  std::vector<bool> is_padded(ct.values.size(), false);
  Index padded = 0;
  const std::array<Index, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t fast = (axis + 1) % 3, slow = (axis + 2) % 3;
    const double face_mm2 = grid.spacing_mm[Index(fast)] * grid.spacing_mm[Index(slow)];
    const Index length = grid.size[axis];
    for (Index line = 0; line < grid.size[fast] * grid.size[slow]; ++line) {
      const Index start =
          line % grid.size[fast] * stride[fast] + line / grid.size[fast] * stride[slow];
      for (const bool from_end : {false, true}) {
        Index n = 0;
        const auto at = [&] {
          return std::size_t(start + (from_end ? length - 1 - n : n) * stride[axis]);
        };
        for (; n < length && ct.values[at()] == padding.hu; ++n) {
          padded += is_padded[at()] ? 0 : 1;
          is_padded[at()] = true;
        }
        if (n > 0 && n < length && double(ct.values[at()]) >= tissue_hu)
          padding.truncated_mm2 += face_mm2;
      }
    }
  }
  padding.fraction = double(padded) / double(ct.values.size());
  return padding;
}

}  // namespace lefort::image
