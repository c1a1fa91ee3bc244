#include <lefort/anatomy/pad_volume.h>
#include <lefort/anatomy/seeded_watershed.h>
#include <lefort/anatomy/voxel_mask.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <string>

namespace lefort::anatomy::test_voxel_mask {
namespace {

image::Grid grid_of(Index nx, Index ny, Index nz) {
  return {{nx, ny, nz}, {0.9, 1.1, 2.0}, {3.0, 4.0, 5.0}, Mat3::Identity()};
}

Mask random_mask(const image::Grid& grid, double fraction, unsigned seed) {
  std::mt19937 generator(seed);
  std::bernoulli_distribution set(fraction);
  Mask mask{grid, {}};
  for (Index v = 0; v < grid.voxel_count(); ++v) mask.values.push_back(set(generator) ? 1 : 0);
  return mask;
}

Vec3 place(const image::Grid& grid, Index v) {
  return Vec3(double(v % grid.size[0]), double(v / grid.size[0] % grid.size[1]),
              double(v / (grid.size[0] * grid.size[1])))
      .cwiseProduct(grid.spacing_mm);
}

TEST(DistanceTo, EqualsBruteForce) {
  for (const double fraction : {0.003, 0.1, 0.9}) {
    const Mask mask = random_mask(grid_of(11, 9, 13), fraction, 7);
    ASSERT_GT(voxel_count(mask), 0);
    const image::ScalarVolume distance = distance_to(mask);
    for (Index v = 0; v < mask.grid.voxel_count(); ++v) {
      double nearest = 1e9;
      for (Index other = 0; other < mask.grid.voxel_count(); ++other)
        if (mask.values[std::size_t(other)] != 0)
          nearest = std::min(nearest, (place(mask.grid, v) - place(mask.grid, other)).norm());
      EXPECT_NEAR(distance.values[std::size_t(v)], nearest, 1e-4) << "voxel " << v;
    }
  }
}

TEST(DistanceTo, IsTheSameUpToALimit) {
  const Mask mask = random_mask(grid_of(21, 19, 23), 0.01, 11);
  const image::ScalarVolume all = distance_to(mask);
  for (const double max_mm : {0.0, 0.7, 2.0, 4.5}) {
    const image::ScalarVolume limited = distance_to(mask, max_mm);
    for (std::size_t v = 0; v < all.values.size(); ++v) {
      if (double(all.values[v]) <= max_mm)
        EXPECT_EQ(limited.values[v], all.values[v]) << max_mm << " mm, voxel " << v;
      else
        EXPECT_GE(limited.values[v], all.values[v]) << max_mm << " mm, voxel " << v;
    }
  }
}

TEST(DistanceTo, OfAnEmptySetIsFar) {
  const Mask nothing = random_mask(grid_of(4, 3, 2), 0.0, 1);
  for (const float distance : distance_to(nothing).values) EXPECT_EQ(distance, 1e6F);
}

TEST(VoxelMask, OpeningRemovesThinSheetsAndKeepsThickOnes) {
  const image::Grid grid{{30, 30, 30}, {1, 1, 1}, {0, 0, 0}, Mat3::Identity()};
  const auto slab = [&](Index thickness) {
    return mask_where(grid, [&](std::size_t v) {
      const Index i = Index(v) % 30;
      return i >= 10 && i < 10 + thickness;
    });
  };
  EXPECT_EQ(voxel_count(opened(slab(4), 2.0)), 0);
  EXPECT_EQ(opened(slab(5), 2.0).values, slab(5).values) << "faces of the grid erode nothing";
  const Mask gap = mask_where(grid, [&](std::size_t v) { return slab(4).values[v] == 0; });
  EXPECT_EQ(voxel_count(closed(gap, 2.0)), grid.voxel_count());
}

TEST(VoxelMask, ComponentsAreNumberedInTheOrderOfTheirFirstVoxels) {
  Mask mask = random_mask(grid_of(5, 5, 3), 0.0, 1);
  mask.at(4, 0, 0) = mask.at(0, 2, 0) = mask.at(1, 2, 0) = mask.at(2, 3, 0) = 1;
  const Components by_faces = connected_components(mask, Neighbors::kFaces);
  ASSERT_EQ(by_faces.count(), 3);
  EXPECT_EQ(by_faces.component_of.at(4, 0, 0), 1);
  EXPECT_EQ(by_faces.component_of.at(1, 2, 0), 2);
  EXPECT_EQ(by_faces.component_of.at(2, 3, 0), 3);
  EXPECT_EQ(by_faces.voxels, (std::vector<Index>{71, 1, 2, 1}));
  EXPECT_EQ(by_faces.largest(), 2);
  EXPECT_EQ(connected_components(mask, Neighbors::kFacesEdgesCorners).count(), 2);
}

TEST(Smoothed, KeepsConstantsAndLinearRampsAndSums) {
  const image::Grid grid = grid_of(21, 21, 21);
  image::ScalarVolume ramp{grid, std::vector<float>(std::size_t(grid.voxel_count()))};
  image::ScalarVolume spike = ramp;
  for (Index v = 0; v < grid.voxel_count(); ++v) ramp.values[std::size_t(v)] = float(v % 21);
  spike.at(10, 10, 10) = 1.0F;
  const image::ScalarVolume smooth = smoothed(ramp, 1.2);
  for (Index i = 5; i < 16; ++i) EXPECT_NEAR(smooth.at(i, 3, 20), double(i), 1e-4);
  const image::ScalarVolume blob = smoothed(spike, 1.2);
  EXPECT_NEAR(std::accumulate(blob.values.begin(), blob.values.end(), 0.0), 1.0, 1e-5);
  double second_moment = 0.0;
  for (Index i = 0; i < 21; ++i)
    for (Index j = 0; j < 21; ++j)
      for (Index k = 0; k < 21; ++k)
        second_moment += std::pow(double(k - 10), 2) * double(blob.at(i, j, k));
  EXPECT_NEAR(std::sqrt(second_moment) * grid.spacing_mm[2], 1.2, 0.02);
  EXPECT_EQ(smoothed(spike, 0.0).values, spike.values);
}

TEST(Smoothed, TheGaussianHasOneWidthInMmOnVoxelsOfAnyShape) {
  for (const Vec3& spacing_mm : {Vec3(0.4, 0.4, 3.0), Vec3(0.3, 0.3, 0.3), Vec3(1.0, 2.0, 0.7)}) {
    image::ScalarVolume spike{{{61, 61, 61}, spacing_mm, {0, 0, 0}, Mat3::Identity()}, {}};
    spike.values.assign(61 * 61 * 61, 0.0F);
    spike.at(30, 30, 30) = 1.0F;
    const image::ScalarVolume blob = smoothed(spike, 2.5);
    Vec3 second_moment = Vec3::Zero();
    for (Index k = 0; k < 61; ++k)
      for (Index j = 0; j < 61; ++j)
        for (Index i = 0; i < 61; ++i)
          second_moment += (Vec3(double(i), double(j), double(k)) - Vec3(30, 30, 30))
                               .cwiseProduct(spacing_mm)
                               .cwiseAbs2() *
                           double(blob.at(i, j, k));
    for (Index axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(std::sqrt(second_moment[axis]), 2.5, 0.05) << spacing_mm.transpose();
  }
}

TEST(VoxelMask, FacesOfTheGridDoNotErodeASetButClosingFillsTheGapToThem) {
  Mask slab{{{12, 3, 3}, {1, 1, 1}, {0, 0, 0}, Mat3::Identity()}, {}};
  for (Index v = 0; v < 12 * 9; ++v) slab.values.push_back(v % 12 >= 6 && v % 12 < 10 ? 1 : 0);
  const Mask thin = eroded(slab, 1.0), tight = closed(slab, 2.0);
  for (Index i = 0; i < 12; ++i) {
    EXPECT_EQ(thin.at(i, 0, 0), i == 7 || i == 8 ? 1 : 0) << i;  // j and k = 0 are faces.
    EXPECT_EQ(tight.at(i, 1, 1), i >= 6 ? 1 : 0) << i;           // Two voxels to the face i = 11.
  }
}

TEST(VoxelMask, DilationIsALengthAndAtLeastTheNextVoxel) {
  Mask dot{{{21, 21, 21}, {0.4, 0.4, 3.0}, {0, 0, 0}, Mat3::Identity()}, {}};
  dot.values.assign(21 * 21 * 21, 0);
  dot.at(10, 10, 10) = 1;
  const Mask around = dilated_by_one_voxel_or_more(dot, 1.5);
  for (Index k = 0; k < 21; ++k)
    for (Index j = 0; j < 21; ++j)
      for (Index i = 0; i < 21; ++i) {
        const bool next = i == 10 && j == 10 && std::abs(k - 10) == 1;
        const bool near = k == 10 && std::hypot(0.4 * double(i - 10), 0.4 * double(j - 10)) <= 1.5;
        ASSERT_EQ(around.at(i, j, k), next || near ? 1 : 0) << i << ' ' << j << ' ' << k;
      }
}

TEST(SeededWatershed, SeedsMeetAtTheNarrowestCrossSection) {
  // Two rooms and a corridor, seen from above; the corridor is narrowest at column 12.
  const std::vector<std::string> plan{"########.....#########",  //
                                      "#......##...##.......#",  //
                                      "#....................#",  //
                                      "#.......#.#.#........#",  //
                                      "#......######........#",  //
                                      "#....................#"};
  Mask room{{{22, 6, 1}, {1, 1, 1}, {0, 0, 0}, Mat3::Identity()}, {}};
  image::Volume<std::int32_t> seeds{room.grid, std::vector<std::int32_t>(22 * 6, 0)};
  for (const std::string& row : plan)
    for (const char c : row) room.values.push_back(c == '.' ? 1 : 0);
  for (Index i = 0; i < 22; ++i) room.at(i, 5, 0) = 0;  // No second passage.
  for (Index i = 7; i < 13; ++i) room.at(i, 3, 0) = 0;
  room.at(12, 1, 0) = room.at(12, 3, 0) = 0;
  seeds.at(1, 2, 0) = 1;
  seeds.at(20, 2, 0) = 2;
  const image::ScalarVolume width =
      distance_to(mask_where(room.grid, [&](std::size_t v) { return room.values[v] == 0; }));
  const auto basins = seeded_watershed(seeds, room, width);
  EXPECT_EQ(basins.at(5, 2, 0), 1);
  EXPECT_EQ(basins.at(15, 2, 0), 2);
  EXPECT_EQ(basins.at(0, 0, 0), 0) << "walls are not assigned";
  for (Index v = 0; v < room.grid.voxel_count(); ++v)
    EXPECT_EQ(basins.values[std::size_t(v)] != 0, room.values[std::size_t(v)] != 0);
}

TEST(PadVolume, CroppingUndoesPaddingAndVoxelsKeepTheirPositions) {
  image::Volume<int> volume{grid_of(3, 2, 2), {}};
  volume.grid.direction = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).matrix();
  for (int v = 0; v < 12; ++v) volume.values.push_back(v);
  const Margin margin{{1, 0, 2}, {0, 3, 1}};
  const auto wide = padded(volume, margin, -1);
  EXPECT_EQ(wide.grid.size, (std::array<Index, 3>{4, 5, 5}));
  EXPECT_EQ(wide.at(0, 0, 0), -1);
  EXPECT_EQ(wide.at(3, 1, 3), volume.at(2, 1, 1));
  EXPECT_LT((wide.grid.point_L({3, 1, 3}) - volume.grid.point_L({2, 1, 1})).norm(), 1e-12);
  EXPECT_EQ(cropped(wide, margin, volume.grid).values, volume.values);
}

}  // namespace
}  // namespace lefort::anatomy::test_voxel_mask
