#include <lefort/field/storage/octree.h>

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

namespace lefort::field::test_octree {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Octree, DecodesLeavesOfDifferentSize) {
  // Root of 8 cells: child 0 is divided again, child 7 is one leaf in the band.
  const std::string codes =
      "+"
      "+iiiiiii#"
      "oooooo"
      "#";
  auto octree = Octree::decode(8, codes);
  ASSERT_TRUE(octree) << octree.error().message;
  EXPECT_EQ(octree->band_leaf_count(), 2);
  ASSERT_EQ(octree->samples().size(), 15U);  // The two leaves have the corner (4, 4, 4) in common.
  EXPECT_EQ(octree->codes(), codes);

  EXPECT_EQ(octree->cell({0, 0, 0}).corners[5], -kInfinity);
  EXPECT_EQ(octree->cell({0, 0, 0}).cells, 2);
  EXPECT_EQ(octree->cell({7, 0, 0}).corners[0], kInfinity);
  const CellSamples small = octree->cell({3, 2, 3});
  EXPECT_EQ(zone_of(small.corners), Zone::kBand);
  EXPECT_EQ(small.low, (LatticePoint{2, 2, 2}));
  EXPECT_EQ(small.cells, 2);
  EXPECT_EQ(octree->cell({7, 7, 7}).cells, 4);
}

TEST(Octree, DecodesFinestCells) {
  // The children of child 0 of child 0 of the root are finest cells; 1 and 6 are in the band.
  std::string codes = "++";
  codes += char(NodeCode::kBranch);
  append_fine_cells(codes, {0x42, Zone::kInside});
  codes += "???????";
  codes += "ooooooo";
  const auto octree = Octree::decode(8, codes);
  ASSERT_TRUE(octree) << octree.error().message;
  EXPECT_EQ(octree->codes(), codes);
  EXPECT_EQ(octree->band_leaf_count(), 2);
  for (int child = 0; child < 8; ++child) {
    const LatticePoint at = {child & 1, child >> 1 & 1, child >> 2};
    const CellSamples cell = octree->cell(at);
    EXPECT_EQ(cell.low, at);
    EXPECT_EQ(cell.cells, 1);
    EXPECT_EQ(zone_of(cell.corners), child == 1 || child == 6 ? Zone::kBand : Zone::kInside);
  }
  EXPECT_EQ(zone_of(octree->cell({2, 0, 0}).corners), Zone::kUnknown);
  EXPECT_EQ(zone_of(octree->cell({4, 0, 0}).corners), Zone::kOutside);
}

TEST(Octree, CornersOfALeafAreTheSamplesAtItsLatticePoints) {
  auto octree = Octree::decode(8,
                               "+"
                               "#o#oooo#")
                    .value();
  const std::vector<LatticePoint> points = octree.sample_points();
  for (std::size_t s = 0; s < points.size(); ++s)
    octree.samples()[s] = float(points[s][0] + 10 * points[s][1] + 100 * points[s][2]);
  const CellSamples place = octree.cell({1, 6, 2});
  ASSERT_EQ(place.low, (LatticePoint{0, 4, 0}));
  for (int corner = 0; corner < 8; ++corner)
    EXPECT_EQ(place.corners[std::size_t(corner)],
              4 * (corner & 1) + 10 * (4 + 4 * (corner >> 1 & 1)) + 100 * 4 * (corner >> 2));
}

TEST(Octree, RejectsLettersThatAreNotATree) {
  for (const char* codes : {"", "+", "+ooooooo", "oo", "x", "+oooooooo#", "+++++#", "+o"}) {
    const auto octree = Octree::decode(8, codes);
    ASSERT_FALSE(octree) << codes;
    EXPECT_EQ(octree.error().code, ErrorCode::kFileCorrupt);
  }
}

TEST(Octree, RejectsCellsSmallerThanTheFinest) {
  // Below two cells there are no nodes, but two letters: which cells are leaves, and the zone of
  // the others.
  const auto with_letters = [](const std::string& letters) {
    return Octree::decode(8, "+++" + letters + "ooooooo" + "ooooooo");
  };
  EXPECT_TRUE(with_letters("\xFFo"));
  EXPECT_TRUE(with_letters("+i"));  // The first is a number, whatever letter it represents.
  EXPECT_FALSE(with_letters("oooooooo"));
  EXPECT_FALSE(with_letters("+oooooooo"));
  EXPECT_FALSE(with_letters("\x01#"));
  EXPECT_FALSE(with_letters("\x01+"));
  EXPECT_FALSE(with_letters(""));
  EXPECT_FALSE(Octree::decode(8, "+++"));
  EXPECT_FALSE(Octree::decode(8, "+++\x01"));
}

/// A random tree, and whether each finest cell is in a band leaf, by direct traversal.
std::string any_tree(std::mt19937& random, int cells) {
  if (cells > 2 && random() % 2 == 0) {
    std::string codes = "+";
    for (int child = 0; child < 8; ++child) codes += any_tree(random, cells / 2);
    return codes;
  }
  if (cells == 2 && random() % 2 == 0) {
    std::string codes = "+";
    append_fine_cells(codes, {std::uint8_t(random() % 256), Zone(1 + random() % 3)});
    return codes;
  }
  return std::string(1, "#oi?"[random() % 4]);
}

TEST(Octree, AnyTreeIsEncodedAgainAndFindsItsSamples) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const std::string codes = any_tree(random, 16);
    auto decoded = Octree::decode(16, codes);
    ASSERT_TRUE(decoded) << seed;
    Octree octree = std::move(*decoded);
    ASSERT_EQ(octree.codes(), codes) << seed;
    const std::vector<LatticePoint> points = octree.sample_points();
    for (std::size_t s = 0; s < points.size(); ++s)
      octree.samples()[s] = float(points[s][0] + 20 * points[s][1] + 400 * points[s][2]);
    Index leaves = 0;
    for (int k = 0; k < 16; ++k)
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i) {
          const CellSamples cell = octree.cell({i, j, k});
          ASSERT_TRUE(cell.low[0] <= i && i < cell.low[0] + cell.cells) << seed;
          if (zone_of(cell.corners) != Zone::kBand) continue;
          leaves += cell.low == LatticePoint{i, j, k} ? 1 : 0;
          for (int corner = 0; corner < 8; ++corner)
            ASSERT_EQ(cell.corners[std::size_t(corner)],
                      cell.low[0] + cell.cells * (corner & 1) +
                          20 * (cell.low[1] + cell.cells * (corner >> 1 & 1)) +
                          400 * (cell.low[2] + cell.cells * (corner >> 2)))
                << seed;
        }
    EXPECT_EQ(leaves, octree.band_leaf_count()) << seed;
  }
}

TEST(Octree, AcceptsOrRejectsAnyLettersWithoutHarm) {
  for (unsigned seed = 0; seed < 3000; ++seed) {
    std::mt19937 random(seed);
    std::string codes = any_tree(random, 16);
    for (auto edits = 1 + random() % 3; edits > 0; --edits)
      codes[random() % codes.size()] =
          char(random() % 4 == 0 ? random() % 256 : "+#oi?"[random() % 5]);
    if (random() % 4 == 0) codes.resize(random() % (codes.size() + 1));
    const auto octree = Octree::decode(16, codes);
    if (!octree) {
      EXPECT_EQ(octree.error().code, ErrorCode::kFileCorrupt);
      continue;
    }
    EXPECT_EQ(octree->codes(), codes);
    for (int n = 0; n < 20; ++n)
      static_cast<void>(octree->cell({int(random() % 16), int(random() % 16), int(random() % 16)}));
  }
}

}  // namespace
}  // namespace lefort::field::test_octree
