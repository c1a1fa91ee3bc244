#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/elevation_zone.h>

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "support/shapes.h"

namespace lefort::plan::test_elevation_zone {
namespace {

using geometry::area_mm2;
using geometry::TriangleMesh;

const TriangleMesh kBar = test::make_box({-10, -20, -10}, {10, 20, 10});

CutSegments cut(const TriangleMesh& skull_L, const std::vector<PlannedSegment>& planned) {
  return cut_segments(skull_L, planned).value();
}

PlannedSegment segment(const Osteotomy& osteotomy) { return {.osteotomy = osteotomy, .cut = {}}; }

TEST(CutFaces, OfAPlaneAreItsSectionOfTheBone) {
  const Osteotomy osteotomy{"front", {{{0, -5, 0}, {0, -1, 0}}}};
  const CutSegments bones = cut(kBar, {segment(osteotomy)});
  const TriangleMesh faces = cut_faces(bones.segments_L[0], osteotomy);
  EXPECT_NEAR(area_mm2(faces), 20.0 * 20.0, 1e-3);
  for (const Vec3& vertex : faces.vertices) EXPECT_NEAR(vertex.y(), -5.0, 0.02);
  EXPECT_NEAR(area_mm2(cut_faces(bones.remainder_L, osteotomy)), 20.0 * 20.0, 1e-3);
}

TEST(CutFaces, OfTwoPlanesAreBoth) {
  const Osteotomy osteotomy{"corner", {{{0, -5, 0}, {0, -1, 0}}, {{0, 0, 2}, {0, 0, 1}}}};
  const CutSegments bones = cut(kBar, {segment(osteotomy)});
  EXPECT_NEAR(area_mm2(cut_faces(bones.segments_L[0], osteotomy)), 20.0 * 8.0 + 20.0 * 15.0, 1e-3);
}

TEST(CutFaces, OfABoundedPlaneLieWithinItsBounds) {
  const TriangleMesh two = test::join(kBar, test::make_box({30, -5, -10}, {50, 20, 10}));
  const Osteotomy osteotomy{"front",
                            {CutPlane{{0, -5, 0}, {0, -1, 0}, PlaneBounds{{1, 0, 0}, 30.0, 30.0}}}};
  const CutSegments bones = cut(two, {segment(osteotomy)});
  EXPECT_NEAR(area_mm2(cut_faces(bones.segments_L[0], osteotomy)), 20.0 * 20.0, 1e-3);
  // A side of the other bar lies in the plane, outside its bounds: it was not cut.
  // A rim along the 80 mm of its border lies in the plane within the tolerance.
  constexpr double kRim_mm2 = 80.0 * 0.02;
  EXPECT_NEAR(area_mm2(cut_faces(bones.remainder_L, osteotomy)), 20.0 * 20.0, kRim_mm2);
  Osteotomy unbounded = osteotomy;
  unbounded.planes[0].bounds.reset();
  EXPECT_NEAR(area_mm2(cut_faces(bones.remainder_L, unbounded)), 2.0 * 20.0 * 20.0, kRim_mm2);
}

TEST(CutFaces, OfACurveAreItsSidesAndItsFloor) {
  CutCurve window{{{-6, -30, -4}, {6, -30, -4}, {6, -30, 4}, {-6, -30, 4}}, {0, 1, 0}};
  const auto faces_of = [&](std::optional<double> depth_mm) {
    window.depth_mm = depth_mm;
    const Osteotomy osteotomy{"window", {}, {window}};
    const CutSegments bones = cut(kBar, {segment(osteotomy)});
    return area_mm2(cut_faces(bones.segments_L[0], osteotomy));
  };
  constexpr double kAround_mm = 2.0 * (12.0 + 8.0);
  EXPECT_NEAR(faces_of(std::nullopt), kAround_mm * 40.0, 1e-2);
  EXPECT_NEAR(faces_of(20.0), kAround_mm * 10.0 + 12.0 * 8.0, 1e-2);  // 10 mm into the bone.
}

TEST(CutFaces, OfAdditionalRegionsAreIncluded) {
  Osteotomy osteotomy{"ends", {{{0, -5, 0}, {0, -1, 0}}}};
  osteotomy.additional_regions = {{.planes = {{{0, 12, 0}, {0, 1, 0}}}, .curves = {}}};
  const CutSegments bones = cut(kBar, {segment(osteotomy)});
  EXPECT_NEAR(area_mm2(cut_faces(bones.segments_L[0], osteotomy)), 2.0 * 20.0 * 20.0, 1e-3);
}

/// A mandible that moves as a whole has no cut faces: nothing is elevated.
TEST(CutFaces, AWholeBodyHasNone) {
  const TriangleMesh two = test::join(kBar, test::make_box({30, -20, -10}, {50, 20, 10}));
  const Osteotomy osteotomy{"whole", {{{20, 0, 0}, {-1, 0, 0}}}};
  const CutSegments bones = cut(two, {segment(osteotomy)});
  EXPECT_TRUE(cut_faces(bones.segments_L[0], osteotomy).triangles.empty());
  const auto zones = elevation_zones(bones, std::vector{segment(osteotomy)}, std::nullopt);
  ASSERT_EQ(zones.size(), 1U);
  EXPECT_TRUE(zones[0].cut_faces_L.triangles.empty());
}

TEST(ElevationZones, HaveTheMarginsOfTheProcedureOrOfThePlan) {
  Osteotomy front{"front", {{{0, -5, 0}, {0, -1, 0}}}};
  front.procedure = OsteotomyTemplate::kLeFort1;
  const Osteotomy back{"back", {{{0, 12, 0}, {0, 1, 0}}}};
  const std::vector<PlannedSegment> planned{segment(front), segment(back)};
  const CutSegments bones = cut(kBar, planned);
  const auto zones = elevation_zones(bones, planned, std::nullopt);
  ASSERT_EQ(zones.size(), 2U);
  EXPECT_EQ(zones[0].margins.segment_mm, 5.0);
  EXPECT_EQ(zones[0].margins.other_side_mm, 12.0);
  EXPECT_EQ(zones[1].margins.segment_mm, 8.0);
  EXPECT_EQ(zones[1].margins.other_side_mm, 8.0);
  for (const ElevationZone& zone : zones) EXPECT_NEAR(area_mm2(zone.cut_faces_L), 400.0, 1e-3);
  for (const ElevationZone& zone : elevation_zones(bones, planned, 3.0)) {
    EXPECT_EQ(zone.margins.segment_mm, 3.0);
    EXPECT_EQ(zone.margins.other_side_mm, 3.0);
  }
}

/// The table in docs/theory/interface.md.
TEST(ElevationZones, MarginsOfEachProcedure) {
  const auto expect_margins = [](std::optional<OsteotomyTemplate> procedure, double segment_mm,
                                 double other_side_mm) {
    EXPECT_EQ(elevation_margins(procedure).segment_mm, segment_mm);
    EXPECT_EQ(elevation_margins(procedure).other_side_mm, other_side_mm);
  };
  expect_margins(OsteotomyTemplate::kLeFort1, 5.0, 12.0);
  expect_margins(OsteotomyTemplate::kLeFort2, 8.0, 15.0);
  expect_margins(OsteotomyTemplate::kLeFort3, 8.0, 15.0);
  expect_margins(OsteotomyTemplate::kGenioplasty, 3.0, 10.0);
  expect_margins(OsteotomyTemplate::kSagittalSplit, 10.0, 10.0);
  expect_margins(std::nullopt, 8.0, 8.0);
}

}  // namespace
}  // namespace lefort::plan::test_elevation_zone
