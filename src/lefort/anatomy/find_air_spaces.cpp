#include <lefort/anatomy/find_air_spaces.h>
#include <lefort/anatomy/seeded_watershed.h>

#include <algorithm>

namespace lefort::anatomy {
namespace {

// Mucosa and blurred thin bone lie between air and bone: a wall this close to bone counts as bony.
constexpr double kMucosa_mm = 2.5;
// Min fraction of bony walls of a sinus. Fitted to one clinical scan (Debian's Cranium), where
// sinuses had 0.80 and more, the nasal cavity 0.57, pharynx and nostrils below 0.3. Not tested on
// other patients.
constexpr double kBonyFraction = 0.7;
// Smaller widenings of a narrow passage are not separate rooms.
constexpr double kMinRoom_ml = 0.05;

/// Divides air into rooms and slits. Rooms are the components that remain when ostia are closed by
/// erosion, grown back by the eroded distance; slits are the components of the remaining air.
Components rooms_and_slits(const Mask& air, const image::ScalarVolume& to_wall,
                           double ostium_radius_mm) {
  const image::Grid& grid = air.grid;
  const double closing_mm = ostium_radius_mm + 0.5 * grid.spacing_mm.minCoeff();
  const Components cores = connected_components(
      mask_where(grid,
                 [&](std::size_t v) {
                   return air.values[v] != 0 && double(to_wall.values[v]) > closing_mm;
                 }),
      Neighbors::kFaces);
  image::Volume<std::int32_t> seeds = cores.component_of;
  for (std::int32_t& seed : seeds.values)
    if (double(cores.voxels[std::size_t(seed)]) * voxel_ml(grid) < kMinRoom_ml) seed = 0;
  const image::ScalarVolume to_seed =
      distance_to(mask_where(grid, [&](std::size_t v) { return seeds.values[v] != 0; }));
  const Mask near = mask_where(grid, [&](std::size_t v) {
    return air.values[v] != 0 &&
           double(to_seed.values[v]) <= closing_mm + 0.5 * grid.spacing_mm.minCoeff();
  });

  Components rooms{seeded_watershed(seeds, near, to_wall), {}};
  const Components slits = connected_components(
      mask_where(
          grid,
          [&](std::size_t v) { return air.values[v] != 0 && rooms.component_of.values[v] == 0; }),
      Neighbors::kFaces);
  rooms.voxels.assign(std::size_t(cores.count() + slits.count() + 1), 0);
  for (std::size_t v = 0; v < air.values.size(); ++v) {
    std::int32_t& room = rooms.component_of.values[v];
    if (slits.component_of.values[v] != 0) room = cores.count() + slits.component_of.values[v];
    ++rooms.voxels[std::size_t(room)];
  }
  return rooms;
}

/// For each room, the fraction of its voxels at a wall whose wall is bony; 0 without walls.
std::vector<double> bony_fractions(const Components& rooms, const image::ScalarVolume& to_wall,
                                   const image::ScalarVolume& to_bone) {
  const double adjacent_mm = 1.001 * rooms.component_of.grid.spacing_mm.maxCoeff();
  std::vector<double> walls(rooms.voxels.size(), 0.0);
  std::vector<double> bony(rooms.voxels.size(), 0.0);
  for (std::size_t v = 0; v < to_wall.values.size(); ++v) {
    const auto room = std::size_t(rooms.component_of.values[v]);
    if (room == 0 || double(to_wall.values[v]) > adjacent_mm) continue;
    walls[room] += 1.0;
    if (double(to_bone.values[v]) <= adjacent_mm + kMucosa_mm) bony[room] += 1.0;
  }
  for (std::size_t room = 1; room < bony.size(); ++room) bony[room] /= std::max(walls[room], 1.0);
  return bony;
}

}  // namespace

AirSpaces find_air_spaces(const Mask& air, const Mask& bone, const Mask& outside,
                          const SegmentationOptions& options) {
  const image::Grid& grid = air.grid;
  // Outside air is not a wall, so the width of nostrils is not limited by it.
  const image::ScalarVolume to_wall = distance_to(mask_where(
      grid, [&](std::size_t v) { return air.values[v] == 0 && outside.values[v] == 0; }));
  const Components rooms = rooms_and_slits(air, to_wall, options.ostium_radius_mm);
  const std::vector<double> fractions = bony_fractions(rooms, to_wall, distance_to(bone));
  const Mask near_outside = dilated(outside, 1.001 * grid.spacing_mm.maxCoeff());
  const std::vector<std::uint8_t> is_open = components_overlapping(rooms, near_outside);
  std::vector<std::uint8_t> is_sinus(fractions.size(), 0);
  for (std::size_t room = 1; room < fractions.size(); ++room)
    is_sinus[room] = is_open[room] == 0 && fractions[room] >= kBonyFraction ? 1 : 0;
  Mask sinus = select_components(rooms, is_sinus);

  const Components components = connected_components(
      mask_where(grid, [&](std::size_t v) { return air.values[v] != 0 && sinus.values[v] == 0; }),
      Neighbors::kFaces);
  std::vector<std::uint8_t> is_airway = components_overlapping(components, near_outside);
  for (std::size_t component = 1; component < is_airway.size(); ++component)
    if (double(components.voxels[component]) * voxel_ml(grid) >= options.min_air_ml)
      is_airway[component] = 1;
  return {select_components(components, is_airway), std::move(sinus)};
}

}  // namespace lefort::anatomy
