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

/// Labels and CT numbers of the box around the bone.
struct BoneBox {
  const image::CtVolume& ct;
  LabelMap labels;

  /// Whether bone of at least `min_hu` lies within kDensest_mm from a voxel, straight ahead and
  /// with no gap.
  [[nodiscard]] bool rises(std::array<Index, 3> at, std::size_t axis, Index side,
                           double min_hu) const {
    const double spacing_mm = labels.grid.spacing_mm[Index(axis)];
    const Index steps = std::max<Index>(1, Index(std::lround(kDensest_mm / spacing_mm)));
    for (Index step = 0; step < steps; ++step) {
      at[axis] += side;
      if (at[axis] < 0 || at[axis] >= labels.grid.size[axis]) return false;
      if (!is_bone(labels.at(at[0], at[1], at[2]))) return false;
      if (double(ct.at(at[0], at[1], at[2])) >= min_hu) return true;
    }
    return false;
  }
  /// What a bone voxel below `min_hu` becomes: soft tissue or brain if it lies between that and
  /// denser bone along an axis. Thin bone does not.
  [[nodiscard]] Tissue without_border(const std::array<Index, 3>& at, double min_hu) const {
    Tissue tissue = labels.at(at[0], at[1], at[2]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const Index side : {-1, 1}) {
        std::array<Index, 3> beside = at;
        beside[axis] += side;
        if (beside[axis] < 0 || beside[axis] >= labels.grid.size[axis]) continue;
        const Tissue other = labels.at(beside[0], beside[1], beside[2]);
        if (is_bone(other) || !rises(at, axis, -side, min_hu)) continue;
        if (other == Tissue::kBrain) return Tissue::kBrain;
        tissue = Tissue::kSoftTissue;
      }
    return tissue;
  }
};

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
    const BoneBox before{near_ct, near};
    parallel_for(grid.size[2], [&](Index k) {
      for (Index j = 0; j < grid.size[1]; ++j)
        for (Index i = 0; i < grid.size[0]; ++i) {
          const auto v = std::size_t(grid.offset(i, j, k));
          if (!is_bone(near.values[v])) continue;
          const double max_hu = std::min(double(densest.values[v]), kMaxTissue_hu);
          const double half_hu = 0.5 * (kBesideBone_hu + max_hu);
          if (double(near_ct.values[v]) < half_hu)
            near.values[v] = before.without_border({i, j, k}, half_hu);
        }
    });
  }
  remove_islands(near);
  paste(near, margin, labels);
}

}  // namespace lefort::anatomy
