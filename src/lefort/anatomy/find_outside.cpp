#include <lefort/anatomy/find_ct_table.h>
#include <lefort/anatomy/find_outside.h>
#include <lefort/anatomy/pad_volume.h>

#include <algorithm>
#include <cmath>

namespace lefort::anatomy {
namespace {

// Cavities that are not deeper than this belong to the outside: the concha of the ear, the crease
// beside the nose.
constexpr double kMaxDepth_mm = 12.0;

/// Margin for the ball on all sides of the scan except the lower one.
Margin margin_for_ball(const image::Grid& grid, double radius_mm) {
  Margin margin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Index voxels = Index(std::ceil(radius_mm / grid.spacing_mm[Index(axis)])) + 1;
    margin.first[axis] = voxels;
    margin.last[axis] = voxels;
  }
  const std::size_t vertical = long_axis(grid);
  const bool upwards = grid.direction(2, Index(vertical)) > 0.0;
  (upwards ? margin.first : margin.last)[vertical] = 0;
  return margin;
}

/// The voxels that the ball covers in all positions it can reach, on the padded grid.
Mask swept_by_ball(const Mask& patient, const Margin& margin, double radius_mm) {
  const Mask wide = padded(patient, margin, std::uint8_t(0));
  const image::ScalarVolume room = distance_to(wide);
  const Components positions = connected_components(
      mask_where(wide.grid, [&](std::size_t v) { return double(room.values[v]) > radius_mm; }),
      Neighbors::kFaces);
  // The ball starts in the margin, which is free of the patient.
  Mask start{wide.grid, std::vector<std::uint8_t>(wide.values.size(), 0)};
  for (Index k = 0; k < wide.grid.size[2]; ++k)
    for (Index j = 0; j < wide.grid.size[1]; ++j)
      for (Index i = 0; i < wide.grid.size[0]; ++i) {
        const std::array<Index, 3> at{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis)
          if ((margin.first[axis] > 0 && at[axis] == 0) ||
              (margin.last[axis] > 0 && at[axis] == wide.grid.size[axis] - 1))
            start.at(i, j, k) = 1;
      }
  return dilated(select_components(positions, components_overlapping(positions, start)), radius_mm);
}

}  // namespace

Mask find_outside(const Mask& patient, double nostril_radius_mm) {
  const image::Grid& grid = patient.grid;
  const Margin margin = margin_for_ball(grid, nostril_radius_mm);
  const Mask swept = cropped(swept_by_ball(patient, margin, nostril_radius_mm), margin, grid);
  const Mask reached = mask_where(
      grid, [&](std::size_t v) { return patient.values[v] == 0 && swept.values[v] != 0; });

  const image::ScalarVolume depth_mm = distance_to(reached);
  const Components cavities = connected_components(
      mask_where(grid,
                 [&](std::size_t v) { return patient.values[v] == 0 && reached.values[v] == 0; }),
      Neighbors::kFaces);
  std::vector<float> entrance_mm(cavities.voxels.size(), 1e6F);
  std::vector<float> max_depth_mm(cavities.voxels.size(), 0.0F);
  for (std::size_t v = 0; v < depth_mm.values.size(); ++v) {
    const auto cavity = std::size_t(cavities.component_of.values[v]);
    entrance_mm[cavity] = std::min(entrance_mm[cavity], depth_mm.values[v]);
    max_depth_mm[cavity] = std::max(max_depth_mm[cavity], depth_mm.values[v]);
  }
  const double neighbor_mm = 1.001 * grid.spacing_mm.maxCoeff();
  return mask_where(grid, [&](std::size_t v) {
    const auto cavity = std::size_t(cavities.component_of.values[v]);
    const bool shallow = cavity != 0 && double(entrance_mm[cavity]) <= neighbor_mm &&
                         double(max_depth_mm[cavity]) <= kMaxDepth_mm;
    return reached.values[v] != 0 || shallow;
  });
}

}  // namespace lefort::anatomy
