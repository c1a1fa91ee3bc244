#include <lefort/field/octree.h>

#include <gtest/gtest.h>

#include <string>

namespace lefort::field {
namespace {

TEST(Octree, DecodesLeavesOfDifferentSize) {
  // Root of 8 cells: child 0 is cut once more, child 7 is one leaf in the band.
  const std::string codes =
      "+"
      "+iiiiiii#"
      "oooooo"
      "#";
  auto octree = Octree::decode(8, codes);
  ASSERT_TRUE(octree) << octree.error().message;
  EXPECT_EQ(octree->node_count(), 17);
  EXPECT_EQ(octree->count(NodeCode::kBand), 2);
  ASSERT_EQ(octree->samples().size(), 15U);  // The two leaves share the corner (4, 4, 4).

  EXPECT_EQ(octree->find({0, 0, 0}).zone, Zone::kInside);
  EXPECT_EQ(octree->find({7, 0, 0}).zone, Zone::kOutside);
  const Octree::Place small = octree->find({3, 2, 3});
  EXPECT_EQ(small.zone, Zone::kBand);
  EXPECT_EQ(small.leaf.low, (LatticePoint{2, 2, 2}));
  EXPECT_EQ(small.leaf.cells, 2);
  EXPECT_EQ(octree->find({7, 7, 7}).leaf.cells, 4);
}

TEST(Octree, CornersOfALeafAreTheSamplesAtItsLatticePoints) {
  auto octree = Octree::decode(8,
                               "+"
                               "#o#oooo#")
                    .value();
  const std::vector<LatticePoint> points = octree.sample_points();
  for (std::size_t s = 0; s < points.size(); ++s)
    octree.samples()[s] = float(points[s][0] + 10 * points[s][1] + 100 * points[s][2]);
  const Octree::Place place = octree.find({1, 6, 2});
  ASSERT_EQ(place.leaf.low, (LatticePoint{0, 4, 0}));
  for (int corner = 0; corner < 8; ++corner)
    EXPECT_EQ(place.corners[std::size_t(corner)],
              4 * (corner & 1) + 10 * (4 + 4 * (corner >> 1 & 1)) + 100 * 4 * (corner >> 2));
}

TEST(Octree, RefusesLettersThatAreNoTree) {
  for (const char* codes : {"", "+", "+ooooooo", "oo", "x", "+oooooooo#", "+++++#"}) {
    const auto octree = Octree::decode(8, codes);
    ASSERT_FALSE(octree) << codes;
    EXPECT_EQ(octree.error().code, ErrorCode::kFileCorrupt);
  }
}

TEST(Octree, RefusesCellsSmallerThanTheFinest) {
  std::string codes = "oooooooo";
  for (int level = 0; level < 3; ++level) codes = "+" + codes + (level < 2 ? "ooooooo" : "");
  EXPECT_TRUE(Octree::decode(8, codes));
  EXPECT_FALSE(Octree::decode(8, "+" + codes + "ooooooo"));
}

}  // namespace
}  // namespace lefort::field
