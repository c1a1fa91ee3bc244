#include <lefort/anatomy/find_brain.h>
#include <lefort/anatomy/seeded_watershed.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace lefort::anatomy {
namespace {

// Cell size for ray casting: coarse enough to hide sutures and foramina.
constexpr double kCell_mm = 4.0;
// Inside the skull rays in nearly all directions hit bone.
constexpr double kEnclosedFraction = 0.85;
constexpr double kOpenFraction = 0.5;
// The seed of the brain is at least this far from bone ...
constexpr double kSeedDepth_mm = 8.0;
// ... and at least this large; smaller ones are the mouth or an orbit.
constexpr double kMinSeed_ml = 40.0;
// Soft tissue this close to the skin is not brain.
constexpr double kSkin_mm = 3.0;
// Smoothing length of the border across openings.
constexpr double kBorder_mm = 2.0;

/// What a cell contains.
enum class Cell : std::uint8_t { kNothing, kBone, kOutside };

/// The scan, divided into cells of several voxels.
struct Cells {
  std::array<Index, 3> voxels_per_cell{};
  image::Volume<Cell> kinds;

  [[nodiscard]] std::size_t offset(Index i, Index j, Index k) const {
    return std::size_t(
        kinds.grid.offset(i / voxels_per_cell[0], j / voxels_per_cell[1], k / voxels_per_cell[2]));
  }
};

Cells cells_of(const Mask& bone, const Mask& outside) {
  Cells cells;
  image::Grid& grid = cells.kinds.grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double spacing_mm = bone.grid.spacing_mm[Index(axis)];
    Index& voxels = cells.voxels_per_cell[axis];
    voxels = std::max(Index(1), Index(std::lround(kCell_mm / spacing_mm)));
    grid.size[axis] = (bone.grid.size[axis] + voxels - 1) / voxels;
  }
  cells.kinds.values.assign(std::size_t(grid.voxel_count()), Cell::kNothing);
  for (Index k = 0; k < bone.grid.size[2]; ++k)
    for (Index j = 0; j < bone.grid.size[1]; ++j)
      for (Index i = 0; i < bone.grid.size[0]; ++i) {
        Cell& cell = cells.kinds.values[cells.offset(i, j, k)];
        if (bone.at(i, j, k) != 0)
          cell = Cell::kBone;
        else if (outside.at(i, j, k) != 0 && cell == Cell::kNothing)
          cell = Cell::kOutside;
      }
  return cells;
}

/// For each cell, the fraction of the 26 directions to its neighbors in which a ray hits bone
/// before the outside. Directions that leave the scan inside the patient do not count; if they are
/// the majority, the fraction is 0.
image::ScalarVolume enclosure(const image::Volume<Cell>& cells) {
  const image::Grid& grid = cells.grid;
  const auto first_met = [&](std::array<Index, 3> at, const std::array<Index, 3>& step) {
    while (grid.contains(at[0], at[1], at[2])) {
      const Cell cell = cells.at(at[0], at[1], at[2]);
      if (cell != Cell::kNothing) return cell;
      for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += step[axis];
    }
    return Cell::kNothing;
  };
  image::ScalarVolume fractions{grid, std::vector<float>(cells.values.size(), 0.0F)};
  parallel_for(grid.voxel_count(), [&](Index cell) {
    const std::array<Index, 3> at{cell % grid.size[0], cell / grid.size[0] % grid.size[1],
                                  cell / (grid.size[0] * grid.size[1])};
    int bone = 0;
    int outside = 0;
    for (Index direction = 0; direction < 27; ++direction) {
      if (direction == 13) continue;  // The zero vector.
      const Cell met = first_met(at, {direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1});
      bone += met == Cell::kBone ? 1 : 0;
      outside += met == Cell::kOutside ? 1 : 0;
    }
    if (bone + outside >= 13)
      fractions.values[std::size_t(cell)] = float(bone) / float(bone + outside);
  });
  return fractions;
}

/// Seeds of the watershed, and its priority.
struct Seeds {
  image::Volume<std::int32_t> seeds;  ///< 1 in the brain, 2 in facial tissue, 0 elsewhere.
  image::ScalarVolume width_mm;
};

/// \returns nothing if bone encloses no large enough region.
std::optional<Seeds> find_seeds(const Mask& soft, const Mask& bone, const Mask& outside) {
  const image::Grid& grid = soft.grid;
  const Cells cells = cells_of(bone, outside);
  const image::ScalarVolume fractions = enclosure(cells.kinds);
  const auto fraction = [&](std::size_t v) {
    const auto [ni, nj, nk] = grid.size;
    const auto at = Index(v);
    return double(fractions.values[cells.offset(at % ni, at / ni % nj, at / (ni * nj))]);
  };

  Seeds found{{grid, std::vector<std::int32_t>(soft.values.size(), 0)},
              distance_to(mask_where(grid, [&](std::size_t v) {
                return soft.values[v] == 0 && outside.values[v] == 0;
              }))};
  {  // Limits the lifetime of large volumes: a scan may have more than 10^8 voxels.
    const Components enclosed = connected_components(
        mask_where(grid,
                   [&](std::size_t v) {
                     return soft.values[v] != 0 && fraction(v) >= kEnclosedFraction &&
                            double(found.width_mm.values[v]) >= kSeedDepth_mm;
                   }),
        Neighbors::kFaces);
    const std::int32_t cavity = enclosed.largest();
    if (double(enclosed.voxels[std::size_t(cavity)]) * voxel_ml(grid) < kMinSeed_ml || cavity == 0)
      return std::nullopt;
    for (std::size_t v = 0; v < soft.values.size(); ++v)
      found.seeds.values[v] = enclosed.component_of.values[v] == cavity ? 1 : 0;
  }
  const image::ScalarVolume to_skin = distance_to(outside);
  for (std::size_t v = 0; v < soft.values.size(); ++v)
    if (soft.values[v] != 0 && found.seeds.values[v] == 0 &&
        (double(to_skin.values[v]) <= kSkin_mm || fraction(v) <= kOpenFraction))
      found.seeds.values[v] = 2;
  return found;
}

}  // namespace

Mask find_brain(const Mask& soft, const Mask& bone, const Mask& outside) {
  const image::Grid& grid = soft.grid;
  image::Volume<std::int32_t> basins;
  {
    const std::optional<Seeds> found = find_seeds(soft, bone, outside);
    if (!found) return mask_where(grid, [](std::size_t) { return false; });
    basins = seeded_watershed(found->seeds, soft, found->width_mm);
  }

  // Majority of brain and other soft tissue around a voxel; bone and air do not count.
  const auto indicator = [&](const auto& belongs) {
    image::ScalarVolume values{grid, std::vector<float>(soft.values.size())};
    for (std::size_t v = 0; v < values.values.size(); ++v)
      values.values[v] = belongs(v) ? 1.0F : 0.0F;
    return smoothed(std::move(values), kBorder_mm);
  };
  const image::ScalarVolume inside =
      indicator([&](std::size_t v) { return basins.values[v] == 1; });
  const image::ScalarVolume all = indicator([&](std::size_t v) { return basins.values[v] != 0; });
  const Components parts = connected_components(
      mask_where(grid,
                 [&](std::size_t v) {
                   return soft.values[v] != 0 && inside.values[v] > 0.5F * all.values[v];
                 }),
      Neighbors::kFaces);
  const std::int32_t largest = parts.largest();
  return mask_where(
      grid, [&](std::size_t v) { return largest != 0 && parts.component_of.values[v] == largest; });
}

}  // namespace lefort::anatomy
