#include <lefort/anatomy/pad_volume.h>
#include <lefort/anatomy/sharpen_bone.h>
#include <lefort/anatomy/voxel_mask.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lefort::anatomy {
namespace {

// The densest bone is searched within this distance along each axis.
constexpr double kDensest_mm = 1.5;
// Thickness of the blurred border; at least two voxels are examined.
constexpr double kBlurredBorder_mm = 1.0;
constexpr int kMinPasses = 2;
// Soft tissue beside bone.
constexpr double kBesideBone_hu = 40.0;
// Denser voxels count as cortical bone: teeth and metal do not make the bone beside them sparse.
constexpr double kMaxTissue_hu = 1100.0;

/// The maximum over a box of voxels, within kDensest_mm along each axis.
image::CtVolume max_over_box(image::CtVolume values) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Index size = values.grid.size[axis];
    const auto reach = Index(std::lround(kDensest_mm / values.grid.spacing_mm[Index(axis)]));
    for_each_line(values.grid, axis, [&](Index start, Index stride) {
      thread_local std::vector<std::int16_t> line;
      line.resize(std::size_t(size));
      for (Index n = 0; n < size; ++n)
        line[std::size_t(n)] = values.values[std::size_t(start + n * stride)];
      for (Index n = 0; n < size; ++n)
        values.values[std::size_t(start + n * stride)] =
            *std::max_element(line.begin() + std::max<Index>(n - reach, 0),
                              line.begin() + std::min(n + reach + 1, size));
    });
  }
  return values;
}

/// What a bone voxel becomes: its own tissue if no face neighbor is soft tissue or brain.
Tissue without_border(const LabelMap& labels, const std::array<Index, 3>& at) {
  const std::array<Index, 3> stride{1, labels.grid.size[0],
                                    labels.grid.size[0] * labels.grid.size[1]};
  const auto v = std::size_t(labels.grid.offset(at[0], at[1], at[2]));
  Tissue tissue = labels.values[v];
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const Index side : {-1, 1}) {
      if (at[axis] + side < 0 || at[axis] + side >= labels.grid.size[axis]) continue;
      const Tissue other = labels.values[std::size_t(Index(v) + side * stride[axis])];
      if (other == Tissue::kBrain) return Tissue::kBrain;
      if (!is_bone(other)) tissue = Tissue::kSoftTissue;
    }
  return tissue;
}

/// Makes all of the mandible soft tissue that is not connected with its largest component.
void remove_islands(LabelMap& labels) {
  const Components parts = connected_components(
      mask_where(labels.grid, [&](std::size_t v) { return labels.values[v] == Tissue::kMandible; }),
      Neighbors::kFaces);
  const std::int32_t largest = parts.largest();
  for (std::size_t v = 0; v < labels.values.size(); ++v)
    if (labels.values[v] == Tissue::kMandible && parts.component_of.values[v] != largest)
      labels.values[v] = Tissue::kSoftTissue;
}

}  // namespace

void sharpen_bone(const image::CtVolume& ct, LabelMap& labels) {
  const Margin margin = margin_around(labels.grid, {2, 2, 2},
                                      [&](std::size_t v) { return is_bone(labels.values[v]); });
  if (margin.first[0] >= labels.grid.size[0]) return;
  const image::CtVolume near_ct = cropped(ct, margin);
  const image::CtVolume densest = max_over_box(near_ct);
  LabelMap near = cropped(labels, margin);
  const image::Grid& grid = near.grid;
  const int passes =
      std::max(kMinPasses, int(std::ceil(kBlurredBorder_mm / grid.spacing_mm.minCoeff())));
  for (int pass = 0; pass < passes; ++pass) {
    const LabelMap before = near;
    parallel_for(grid.size[2], [&](Index k) {
      for (Index j = 0; j < grid.size[1]; ++j)
        for (Index i = 0; i < grid.size[0]; ++i) {
          const auto v = std::size_t(grid.offset(i, j, k));
          if (!is_bone(before.values[v])) continue;
          const double max_hu = std::min(double(densest.values[v]), kMaxTissue_hu);
          if (double(near_ct.values[v]) < 0.5 * (kBesideBone_hu + max_hu))
            near.values[v] = without_border(before, {i, j, k});
        }
    });
  }
  remove_islands(near);
  paste(near, margin, labels);
}

}  // namespace lefort::anatomy
