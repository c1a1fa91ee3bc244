/// \file
/// A scan made of surfaces: its surfaces must be those that it was made of.
#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/head_from_surfaces.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/geometry/bvh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/shapes.h"

namespace lefort::anatomy::test_head_from_surfaces {
namespace {

using geometry::TriangleMesh;

/// A head with a hollow cranium, large enough for a brain, and a mandible below it.
HeadSurfaces head() {
  return {test::make_icosphere(75.0, 4),
          test::join(test::make_icosphere(45.0, 4, {0, 0, 15}),
                     test::turn_inside_out(test::make_icosphere(36.0, 4, {0, 0, 15}))),
          test::make_box({-12, -30, -55}, {12, -10, -40})};
}

double max_distance_mm(const TriangleMesh& from, const TriangleMesh& onto) {
  const geometry::Bvh tree(onto);
  double max_mm = 0.0;
  for (const Vec3& v : from.vertices) max_mm = std::max(max_mm, tree.closest_point(v)->distance_mm);
  return max_mm;
}

TEST(HeadFromSurfaces, HasTheSurfacesItIsMadeOf) {
  const HeadSurfaces surfaces = head();
  const auto scan = scan_from_surfaces(surfaces, 1.5);
  ASSERT_TRUE(scan) << scan.error().message;
  const auto skin_L = extract_isosurface(skin_level(scan->ct, scan->labels));
  ASSERT_TRUE(skin_L) << skin_L.error().message;
  EXPECT_LT(max_distance_mm(*skin_L, surfaces.skin_L), 0.3);
  LabelMap skull_only = scan->labels;
  std::replace(skull_only.values.begin(), skull_only.values.end(), Tissue::kMandible,
               Tissue::kSoftTissue);
  const auto skull_L = extract_isosurface(bone_level(scan->ct, skull_only, Cavities::kKeep));
  ASSERT_TRUE(skull_L) << skull_L.error().message;
  EXPECT_LT(max_distance_mm(*skull_L, surfaces.skull_L), 0.5);
}

TEST(HeadFromSurfaces, LabelsEachTissue) {
  const auto scan = scan_from_surfaces(head(), 2.0);
  ASSERT_TRUE(scan) << scan.error().message;
  const auto at = [&](const Vec3& p_L) {
    const Vec3 v = scan->labels.grid.index_V(p_L).array().round();
    return scan->labels.at(Index(v[0]), Index(v[1]), Index(v[2]));
  };
  EXPECT_EQ(at({0, 0, 15}), Tissue::kBrain);
  EXPECT_EQ(at({0, 40, 15}), Tissue::kBone);
  EXPECT_EQ(at({0, -20, -47}), Tissue::kMandible);
  EXPECT_EQ(at({0, -55, 0}), Tissue::kSoftTissue);
  EXPECT_EQ(scan->labels.values.front(), Tissue::kBackground);
}

TEST(HeadFromSurfaces, EndsWhereTheSkinIsTruncated) {
  HeadSurfaces surfaces = head();
  surfaces.skin_L = test::make_box({-60, -60, -70}, {60, 60, 70});
  const auto scan = scan_from_surfaces(surfaces, 2.0);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(scan->labels.values.front(), Tissue::kSoftTissue);
  EXPECT_GT(scan->labels.grid.origin_L.z(), -70.0);
}

TEST(HeadFromSurfaces, SurfacesThatEncloseNothingAreRejectedByName) {
  const auto refused = [](const HeadSurfaces& surfaces, const char* words) {
    const auto scan = scan_from_surfaces(surfaces, 2.0);
    ASSERT_FALSE(scan) << words;
    EXPECT_NE(scan.error().message.find(words), std::string::npos) << scan.error().message;
  };
  HeadSurfaces open = head();
  open.skin_L.triangles.pop_back();
  refused(open, "skin: the surface is open (edge ");
  HeadSurfaces nan = head();
  nan.mandible_L->vertices[3].x() = std::numeric_limits<double>::quiet_NaN();
  refused(nan, "mandible: ");
  HeadSurfaces empty = head();
  empty.skull_L = {};
  refused(empty, "skull: ");
  HeadSurfaces apart = head();
  for (Vec3& v : apart.skull_L.vertices) v.x() += 500.0;
  apart.mandible_L.reset();
  refused(apart, "are all surfaces in one frame?");
}

TEST(HeadFromSurfaces, OrientationDoesNotMatter) {
  HeadSurfaces turned = head();
  turned.skin_L = test::turn_inside_out(turned.skin_L);
  EXPECT_EQ(scan_from_surfaces(turned, 3.0)->ct.values, scan_from_surfaces(head(), 3.0)->ct.values);
}

}  // namespace
}  // namespace lefort::anatomy::test_head_from_surfaces
