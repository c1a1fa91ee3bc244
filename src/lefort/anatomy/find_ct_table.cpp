#include <lefort/anatomy/find_ct_table.h>

#include <algorithm>
#include <array>

namespace lefort::anatomy {
namespace {

// A voxel column along the patient belongs to a table if this fraction of it is dense ...
constexpr double kSteady = 0.9;
// ... and if it contains at least this fraction of the columns within kRim_mm that are dense over
// half of their length. Around a limb there are more of them.
constexpr double kSharpness = 0.7;
constexpr double kHalf = 0.5;
constexpr double kRim_mm = 5.0;
// Min width of a table as a fraction of the width of the scan; it must also be three times as wide
// as thick.
constexpr double kWidth = 0.6;
// Removed around the table: its blurred surface.
constexpr double kTableBlur_mm = 2.0;
// With fewer slices the fractions are not reliable.
constexpr Index kMinSlices = 20;

/// The dense fraction of each column along `axis`, on a grid that is one voxel long there.
image::ScalarVolume dense_fractions(const Mask& dense, std::size_t axis) {
  image::Grid flat = dense.grid;
  flat.size[axis] = 1;
  image::ScalarVolume fractions{flat, std::vector<float>(std::size_t(flat.voxel_count()), 0.0F)};
  const float step = 1.0F / float(dense.grid.size[axis]);
  for (Index k = 0; k < dense.grid.size[2]; ++k)
    for (Index j = 0; j < dense.grid.size[1]; ++j)
      for (Index i = 0; i < dense.grid.size[0]; ++i) {
        std::array<Index, 3> at{i, j, k};
        at[axis] = 0;
        if (dense.at(i, j, k) != 0) fractions.at(at[0], at[1], at[2]) += step;
      }
  return fractions;
}

/// True if the columns cover most of the width of the scan and are thin from front to back.
bool is_slab(const Mask& columns) {
  const image::Grid& grid = columns.grid;
  Box3 box_L;
  Box3 scan_L;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const Vec3 p_L = grid.point_L({double(i), double(j), double(k)});
        scan_L.extend(p_L);
        if (columns.at(i, j, k) != 0) box_L.extend(p_L);
      }
  const Vec3 size_mm = box_L.sizes();
  return size_mm[0] >= kWidth * scan_L.sizes()[0] && size_mm[0] >= 3.0 * size_mm[1];
}

/// Mean of y in L, weighted by `weight`; 0 if all weights are zero.
template <class Weight>
double mean_depth(const image::Grid& grid, const Weight& weight) {
  double sum = 0.0;
  double total = 0.0;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const double w = weight(std::size_t(grid.offset(i, j, k)));
        if (w == 0.0) continue;
        sum += w * grid.point_L({double(i), double(j), double(k)})[1];
        total += w;
      }
  return total > 0.0 ? sum / total : 0.0;
}

}  // namespace

std::size_t long_axis(const image::Grid& grid) {
  Index axis = 0;
  grid.direction.row(2).cwiseAbs().maxCoeff(&axis);
  return std::size_t(axis);
}

Mask find_ct_table(const Mask& dense) {
  const std::size_t axis = long_axis(dense.grid);
  const image::ScalarVolume fractions = dense_fractions(dense, axis);
  const image::Grid& flat = fractions.grid;
  const Components steady = connected_components(
      mask_where(flat, [&](std::size_t v) { return double(fractions.values[v]) >= kSteady; }),
      Neighbors::kFacesEdgesCorners);

  Mask table{flat, std::vector<std::uint8_t>(fractions.values.size(), 0)};
  for (std::int32_t part = 1; part <= steady.count(); ++part) {
    const auto is_part = [&](std::size_t v) { return steady.component_of.values[v] == part; };
    const Mask columns = mask_where(flat, is_part);
    if (!is_slab(columns)) continue;
    const Mask around = dilated(columns, kRim_mm);
    Index dense_around = 0;
    for (std::size_t v = 0; v < fractions.values.size(); ++v)
      if (around.values[v] != 0 && double(fractions.values[v]) >= kHalf) ++dense_around;
    const bool sharp =
        double(steady.voxels[std::size_t(part)]) >= kSharpness * double(dense_around);
    const bool behind = mean_depth(flat, [&](std::size_t v) { return is_part(v) ? 1.0 : 0.0; }) >
                        mean_depth(flat, [&](std::size_t v) {
                          return is_part(v) ? 0.0 : double(fractions.values[v]);
                        });
    if (!sharp || !behind || dense.grid.size[axis] < kMinSlices) continue;
    const Mask blurred = dilated(columns, kTableBlur_mm);
    for (std::size_t v = 0; v < table.values.size(); ++v) table.values[v] |= blurred.values[v];
  }

  Mask along{dense.grid, std::vector<std::uint8_t>(dense.values.size(), 0)};
  for (Index k = 0; k < dense.grid.size[2]; ++k)
    for (Index j = 0; j < dense.grid.size[1]; ++j)
      for (Index i = 0; i < dense.grid.size[0]; ++i) {
        std::array<Index, 3> at{i, j, k};
        at[axis] = 0;
        along.at(i, j, k) = dense.at(i, j, k) & table.at(at[0], at[1], at[2]);
      }
  return along;
}

}  // namespace lefort::anatomy
