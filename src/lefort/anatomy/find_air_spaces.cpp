#include <lefort/anatomy/find_air_spaces.h>
#include <lefort/anatomy/seeded_watershed.h>

#include <algorithm>

namespace lefort::anatomy {
namespace {

// Between air and bone lie mucosa and the blur of thin bone: a wall this near to bone is bony.
constexpr double kMucosa_mm = 2.5;
// The share of a sinus's walls that is bony, at least. Fitted to one clinical scan (Debian's
// Cranium), where sinuses had 0.80 and more, the nasal cavity 0.57, pharynx and nostrils below 0.3;
// on no other patient has it been tried.
constexpr double kBonyFraction = 0.7;
// A smaller widening of a narrow place is no room of its own.
constexpr double kMinRoom_ml = 0.05;

/// Rooms: what remains when ostia are shut, given back the margin the shutting took; and what is
/// left over, piece by piece.
Parts rooms_and_slits(const Mask& air, const image::ScalarVolume& to_wall,
                      double ostium_radius_mm) {
  const image::Grid& grid = air.grid;
  const double shut_mm = ostium_radius_mm + 0.5 * grid.spacing_mm.minCoeff();
  const Parts cores = connected_parts(
      mask_where(
          grid,
          [&](std::size_t v) { return air.values[v] != 0 && double(to_wall.values[v]) > shut_mm; }),
      Neighbors::kFaces);
  image::Volume<std::int32_t> seeds = cores.part_of;
  for (std::int32_t& seed : seeds.values)
    if (double(cores.voxels[std::size_t(seed)]) * voxel_ml(grid) < kMinRoom_ml) seed = 0;
  const image::ScalarVolume to_seed =
      distance_to(mask_where(grid, [&](std::size_t v) { return seeds.values[v] != 0; }));
  const Mask near = mask_where(grid, [&](std::size_t v) {
    return air.values[v] != 0 &&
           double(to_seed.values[v]) <= shut_mm + 0.5 * grid.spacing_mm.minCoeff();
  });

  Parts rooms{seeded_watershed(seeds, near, to_wall), {}};
  const Parts slits = connected_parts(
      mask_where(grid,
                 [&](std::size_t v) { return air.values[v] != 0 && rooms.part_of.values[v] == 0; }),
      Neighbors::kFaces);
  rooms.voxels.assign(std::size_t(cores.count() + slits.count() + 1), 0);
  for (std::size_t v = 0; v < air.values.size(); ++v) {
    std::int32_t& room = rooms.part_of.values[v];
    if (slits.part_of.values[v] != 0) room = cores.count() + slits.part_of.values[v];
    ++rooms.voxels[std::size_t(room)];
  }
  return rooms;
}

/// For every room, the share of its voxels at a wall whose wall is bony; 0 if it has none.
std::vector<double> bony_fractions(const Parts& rooms, const image::ScalarVolume& to_wall,
                                   const image::ScalarVolume& to_bone) {
  const double beside_mm = 1.001 * rooms.part_of.grid.spacing_mm.maxCoeff();
  std::vector<double> walls(rooms.voxels.size(), 0.0);
  std::vector<double> bony(rooms.voxels.size(), 0.0);
  for (std::size_t v = 0; v < to_wall.values.size(); ++v) {
    const auto room = std::size_t(rooms.part_of.values[v]);
    if (room == 0 || double(to_wall.values[v]) > beside_mm) continue;
    walls[room] += 1.0;
    if (double(to_bone.values[v]) <= beside_mm + kMucosa_mm) bony[room] += 1.0;
  }
  for (std::size_t room = 1; room < bony.size(); ++room) bony[room] /= std::max(walls[room], 1.0);
  return bony;
}

}  // namespace

AirSpaces find_air_spaces(const Mask& air, const Mask& bone, const Mask& outside,
                          const SegmentationOptions& options) {
  const image::Grid& grid = air.grid;
  // Outside air is no wall: the nostrils are as wide as they are.
  const image::ScalarVolume to_wall = distance_to(mask_where(
      grid, [&](std::size_t v) { return air.values[v] == 0 && outside.values[v] == 0; }));
  const Parts rooms = rooms_and_slits(air, to_wall, options.ostium_radius_mm);
  const std::vector<double> fractions = bony_fractions(rooms, to_wall, distance_to(bone));
  const Mask beside_outside = dilated(outside, 1.001 * grid.spacing_mm.maxCoeff());
  const std::vector<std::uint8_t> is_open = labels_touching(rooms, beside_outside);
  std::vector<std::uint8_t> is_sinus(fractions.size(), 0);
  for (std::size_t room = 1; room < fractions.size(); ++room)
    is_sinus[room] = is_open[room] == 0 && fractions[room] >= kBonyFraction ? 1 : 0;
  Mask sinus = select_labels(rooms, is_sinus);

  const Parts pieces = connected_parts(
      mask_where(grid, [&](std::size_t v) { return air.values[v] != 0 && sinus.values[v] == 0; }),
      Neighbors::kFaces);
  std::vector<std::uint8_t> is_airway = labels_touching(pieces, beside_outside);
  for (std::size_t piece = 1; piece < is_airway.size(); ++piece)
    if (double(pieces.voxels[piece]) * voxel_ml(grid) >= options.min_air_ml) is_airway[piece] = 1;
  return {select_labels(pieces, is_airway), std::move(sinus)};
}

}  // namespace lefort::anatomy
