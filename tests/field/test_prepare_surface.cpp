#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/build/prepare_surface.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "support/shapes.h"
#include "support/ugly_mesh.h"

namespace lefort::field::test_prepare_surface {
namespace {

using geometry::TriangleMesh;

void expect_report(const PreparedSurface& surface, const MeshRepairReport& wanted) {
  const MeshRepairReport& found = surface.report;
  EXPECT_EQ(found.duplicate_vertices, wanted.duplicate_vertices);
  EXPECT_EQ(found.degenerate_triangles, wanted.degenerate_triangles);
  EXPECT_EQ(found.duplicate_triangles, wanted.duplicate_triangles);
  EXPECT_EQ(found.opposite_duplicates, wanted.opposite_duplicates);
  EXPECT_EQ(found.flipped_triangles, wanted.flipped_triangles);
  EXPECT_EQ(found.boundary_edges, wanted.boundary_edges);
  EXPECT_EQ(found.non_manifold_edges, wanted.non_manifold_edges);
  EXPECT_EQ(found.inconsistent_edges, wanted.inconsistent_edges);
}

const TriangleMesh kTorus = test::make_torus(20, 8, 24, 12);

/// Flips one triangle.
TriangleMesh flipped(TriangleMesh mesh, std::size_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
  return mesh;
}

double volume_mm3(const PreparedSurface& surface) {
  return geometry::signed_volume_mm3(surface.mesh_B);
}

TEST(PrepareSurface, DoesNotChangeACleanSurface) {
  const PreparedSurface surface = prepare_surface(kTorus).value();
  EXPECT_TRUE(surface.closed);
  expect_report(surface, MeshRepairReport{});
  EXPECT_TRUE(describe(surface.report).empty());
  EXPECT_TRUE(surface.is_opposite_duplicate.empty());
  EXPECT_EQ(surface.mesh_B.triangles, kTorus.triangles);
  EXPECT_EQ(surface.mesh_B.vertices, kTorus.vertices);
}

TEST(PrepareSurface, WeldsASoupAndCountsWeldedVertices) {
  const PreparedSurface surface = prepare_surface(test::unwelded(kTorus)).value();
  EXPECT_TRUE(surface.closed);
  EXPECT_EQ(surface.mesh_B.vertex_count(), kTorus.vertex_count());
  expect_report(surface, (MeshRepairReport{.duplicate_vertices = 3 * kTorus.triangle_count() -
                                                                 kTorus.vertex_count()}));
  EXPECT_TRUE(describe(surface.report).empty());  // Not reported: every STL needs welding.
}

TEST(PrepareSurface, DropsDuplicates) {
  TriangleMesh mesh = kTorus;
  const auto [a, b, c] = mesh.triangles[17];
  mesh.triangles.insert(mesh.triangles.begin() + 40, {b, c, a});
  mesh.triangles.push_back({c, a, b});
  const PreparedSurface surface = prepare_surface(mesh).value();
  expect_report(surface, MeshRepairReport{.duplicate_triangles = 2});
  EXPECT_EQ(describe(surface.report), std::vector<std::string>{"2 triangles dropped as redundant"});
  EXPECT_TRUE(surface.closed);
  EXPECT_EQ(surface.mesh_B.triangles, kTorus.triangles);  // The first of the three remains.
}

TEST(PrepareSurface, DropsTrianglesWithCoincidentCorners) {
  TriangleMesh mesh = kTorus;
  mesh.triangles.push_back({5, 5, 9});
  const PreparedSurface surface = prepare_surface(mesh).value();
  expect_report(surface, MeshRepairReport{.degenerate_triangles = 1});
  EXPECT_EQ(describe(surface.report),
            std::vector<std::string>{"1 triangle with coincident corners dropped"});
}

TEST(PrepareSurface, OppositeDuplicatesEncloseNoVolume) {
  // A sheet with triangles on both sides; opposite duplicates begin at different corners. At its
  // edges and inner vertices normals cancel up to rounding, which must not create an inside.
  TriangleMesh sheet = test::moved(
      test::make_sheet(10, 4), RigidTransform(Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized())) *
                                   RigidTransform(Eigen::Translation3d(0.1, 0.2, 0.3)));
  const std::vector<geometry::Triangle> front = sheet.triangles;
  for (std::size_t t = 0; t < front.size(); ++t) {
    geometry::Triangle back = {front[t][0], front[t][2], front[t][1]};
    std::rotate(back.begin(), back.begin() + long(t % 3), back.end());
    sheet.triangles.push_back(back);
  }
  const PreparedSurface surface = prepare_surface(sheet).value();
  expect_report(surface, (MeshRepairReport{.opposite_duplicates = 64, .non_manifold_edges = 40}));
  EXPECT_EQ(
      describe(surface.report),
      (std::vector<std::string>{"64 triangles with an opposite duplicate: they enclose no volume",
                                "40 edges with more than two triangles"}));
  EXPECT_EQ(
      std::count(surface.is_opposite_duplicate.begin(), surface.is_opposite_duplicate.end(), true),
      64);
  EXPECT_TRUE(surface.closed);
  for (const FieldMethod method : {FieldMethod::kBricks, FieldMethod::kHybrid,
                                   FieldMethod::kAdaptive, FieldMethod::kUniform}) {
    const DistanceField field =
        build_distance_field(sheet, {.method = method, .resolution = 32, .tolerance_mm = 0.0})
            .value();
    int inside = 0, unknown = 0, samples = 0;
    for (int c = 0; c < 32 * 32 * 32; ++c) {
      const CellSamples cell = field.cell({c % 32, c / 32 % 32, c / 1024});
      for (const float d : cell.corners) inside += d < -1e-6F ? 1 : 0;
      samples += zone_of(cell.corners) == Zone::kBand ? 1 : 0;
      unknown += zone_of(cell.corners) == Zone::kUnknown ? 1 : 0;
    }
    EXPECT_EQ(inside, 0) << "method " << int(method);
    EXPECT_EQ(unknown, 0) << "method " << int(method);
    EXPECT_GT(samples, 1000);
  }
}

TEST(PrepareSurface, AFlapOfOppositeDuplicatesDoesNotFlipTheBone) {
  TriangleMesh mesh = test::make_box(Vec3(0, 0, 0), Vec3(10, 10, 10));
  mesh.vertices.emplace_back(5, 5, 15);  // Perpendicular to the top, along the diagonal 4-7.
  mesh.triangles.push_back({4, 7, 8});
  mesh.triangles.push_back({7, 4, 8});
  const PreparedSurface surface = prepare_surface(mesh).value();
  EXPECT_TRUE(surface.closed);
  expect_report(surface, (MeshRepairReport{.opposite_duplicates = 2, .non_manifold_edges = 1}));
  const DistanceField field = build_distance_field(mesh, {.resolution = 64}).value();
  const TriangleMesh box = test::make_box(Vec3(0, 0, 0), Vec3(10, 10, 10));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in(-1, 16);
  for (int n = 0; n < 5000; ++n) {
    const Vec3 p(in(random), in(random), in(random));
    const FieldSample sample = field.sample(p);
    if (std::abs(sample.distance_mm) < field.cell_mm()) continue;
    EXPECT_EQ(sample.distance_mm<0, geometry::winding_number(box, p)> 0.5) << p.transpose();
  }
}

TEST(PrepareSurface, FlipsOneInconsistentTriangle) {
  for (const std::size_t t : {std::size_t(0), std::size_t(17), kTorus.triangles.size() - 1}) {
    const PreparedSurface surface = prepare_surface(flipped(kTorus, t)).value();
    expect_report(surface, MeshRepairReport{.flipped_triangles = 1});
    EXPECT_EQ(describe(surface.report),
              std::vector<std::string>{"1 triangle flipped to face outward"});
    EXPECT_TRUE(surface.closed);
    EXPECT_NEAR(volume_mm3(surface), geometry::signed_volume_mm3(kTorus), 1e-9);
  }
}

TEST(PrepareSurface, FlipsTheSmallerArea) {
  // A sheet whose left third is inverted: the larger rest is right.
  TriangleMesh sheet = test::make_sheet(12, 6);
  Index turned = 0;
  for (auto& t : sheet.triangles) {
    const double x = (sheet.vertices[std::size_t(t[0])] + sheet.vertices[std::size_t(t[1])] +
                      sheet.vertices[std::size_t(t[2])])
                         .x() /
                     3;
    if (x > -2) continue;
    std::swap(t[0], t[1]);
    ++turned;
  }
  const PreparedSurface surface = prepare_surface(sheet).value();
  expect_report(surface, (MeshRepairReport{.flipped_triangles = turned, .boundary_edges = 24}));
  EXPECT_FALSE(surface.closed);
  for (Index t = 0; t < surface.mesh_B.triangle_count(); ++t)
    EXPECT_GT(geometry::face_normal(surface.mesh_B, t).z(), 0.0);
}

TEST(PrepareSurface, FlipsAnInwardSurface) {
  const PreparedSurface surface = prepare_surface(test::turn_inside_out(kTorus)).value();
  expect_report(surface, MeshRepairReport{.flipped_triangles = kTorus.triangle_count()});
  EXPECT_NEAR(volume_mm3(surface), geometry::signed_volume_mm3(kTorus), 1e-9);
}

TEST(PrepareSurface, DoesNotFlipACavity) {
  const TriangleMesh hollow =
      test::join(test::make_icosphere(29, 2), test::turn_inside_out(test::make_icosphere(20, 2)));
  const PreparedSurface surface = prepare_surface(hollow).value();
  expect_report(surface, MeshRepairReport{});
  EXPECT_NEAR(volume_mm3(surface), geometry::signed_volume_mm3(hollow), 1e-9);
}

TEST(PrepareSurface, AnInwardHollowBallIsFlippedAsAWhole) {
  // Flipping only the outer shell would give a full ball with a ball in it.
  const TriangleMesh hollow =
      test::join(test::make_icosphere(29, 2), test::turn_inside_out(test::make_icosphere(20, 2)));
  const PreparedSurface surface = prepare_surface(test::turn_inside_out(hollow)).value();
  EXPECT_NEAR(volume_mm3(surface), geometry::signed_volume_mm3(hollow), 1e-6);
  expect_report(surface, MeshRepairReport{.flipped_triangles = hollow.triangle_count()});
}

TEST(PrepareSurface, FlipsTheInwardOneOfTwoShells) {
  for (const double bad_radius : {3.0, 10.0}) {  // The smaller or the larger.
    const TriangleMesh mesh =
        test::join(test::make_icosphere(5, 2),
                   test::turn_inside_out(test::make_icosphere(bad_radius, 2, Vec3(30, 0, 0))));
    const PreparedSurface surface = prepare_surface(mesh).value();
    expect_report(surface, MeshRepairReport{.flipped_triangles = 320});
    EXPECT_NEAR(volume_mm3(surface),
                geometry::signed_volume_mm3(test::make_icosphere(5, 2)) +
                    geometry::signed_volume_mm3(test::make_icosphere(bad_radius, 2)),
                1e-6);
  }
}

TEST(PrepareSurface, FlipsAComponentThatTouchesAnotherAtAPoint) {
  const TriangleMesh good = test::make_box(Vec3(0, 0, 0), Vec3(10, 10, 10));
  const TriangleMesh bad =
      test::turn_inside_out(test::make_box(Vec3(10, 10, 10), Vec3(15, 15, 15)));
  const PreparedSurface surface = prepare_surface(test::join(good, bad)).value();
  expect_report(surface, (MeshRepairReport{.duplicate_vertices = 1, .flipped_triangles = 12}));
  EXPECT_NEAR(volume_mm3(surface), 1000 + 125, 1e-9);
}

TEST(PrepareSurface, ComponentsThatTouchAtACornerDoNotEncloseEachOther) {
  // From the common corner every ray into one of them crosses its surface once.
  const TriangleMesh one = test::make_box(Vec3(-1, -1, -1), Vec3(0, 0, 0)),
                     other = test::make_box(Vec3(0, 0, 0), Vec3(2, 2, 2));
  for (int turn = 0; turn < 20; ++turn) {
    const RigidTransform X(Eigen::AngleAxisd(turn, Vec3(1, 2, 3).normalized()));
    for (const bool swapped : {false, true}) {
      const TriangleMesh both = swapped ? test::join(other, one) : test::join(one, other);
      const PreparedSurface surface =
          prepare_surface(test::moved(test::turn_inside_out(both), X)).value();
      EXPECT_EQ(surface.components, 2);
      EXPECT_NEAR(volume_mm3(surface), 9.0, 1e-9) << turn;
    }
  }
}

TEST(PrepareSurface, AMoebiusStripIsInconsistentAndNotChanged) {
  const TriangleMesh strip = test::make_moebius_strip(20, 8, 40);
  const PreparedSurface surface = prepare_surface(strip).value();
  EXPECT_FALSE(surface.closed);
  expect_report(surface, (MeshRepairReport{.boundary_edges = 80, .inconsistent_edges = 1}));
  EXPECT_EQ(surface.mesh_B.triangles, strip.triangles);
  const std::vector<std::string> sentences = describe(surface.report);
  ASSERT_EQ(sentences.size(), 2U);
  EXPECT_EQ(sentences[0],
            "80 edges with one triangle: the surface is open, signs outside the band are unknown");
  EXPECT_EQ(sentences[1],
            "1 edge of inconsistent orientation that flipping cannot repair: signs may be wrong "
            "nearby");
}

TEST(PrepareSurface, CountsBoundaryAndNonManifoldEdges) {
  TriangleMesh box = test::make_box(Vec3(0, 0, 0), Vec3(10, 10, 10));
  box.triangles.pop_back();
  expect_report(*prepare_surface(box), {.boundary_edges = 3});

  const TriangleMesh two = test::join(test::make_box(Vec3(0, 0, 0), Vec3(5, 5, 5)),
                                      test::make_box(Vec3(5, 5, 0), Vec3(10, 10, 5)));
  const PreparedSurface surface = prepare_surface(two).value();
  EXPECT_TRUE(surface.closed);
  expect_report(surface, (MeshRepairReport{.duplicate_vertices = 2, .non_manifold_edges = 1}));
  EXPECT_EQ(describe(surface.report),
            std::vector<std::string>{"1 edge with more than two triangles"});

  TriangleMesh fan;  // Three triangles at one edge.
  fan.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  const PreparedSurface wings = prepare_surface(fan).value();
  EXPECT_FALSE(wings.closed);
  expect_report(wings, (MeshRepairReport{.boundary_edges = 6, .non_manifold_edges = 1}));
}

TEST(PrepareSurface, AllRandomFlipsOfABoneAreRepaired) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    TriangleMesh mesh = test::make_crumpled_ball(seed, 6, 14);
    const double volume = geometry::signed_volume_mm3(mesh);
    for (auto& t : mesh.triangles)
      if (random() % 2 == 0) std::swap(t[0], t[2]);
    const PreparedSurface surface = prepare_surface(test::unwelded(mesh)).value();
    EXPECT_TRUE(surface.closed) << seed;
    EXPECT_NEAR(volume_mm3(surface), volume, 1e-9) << seed;
  }
}

TEST(PrepareSurface, IsIdempotent) {
  // A prepared surface is clean, whatever the input was.
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const auto once = prepare_surface(test::make_ugly_mesh(random));
    if (!once) continue;
    const auto twice = prepare_surface(once->mesh_B);
    ASSERT_TRUE(twice);
    EXPECT_EQ(twice->closed, once->closed) << seed;
    EXPECT_EQ(twice->report.duplicate_triangles, 0) << seed;
    EXPECT_EQ(twice->report.degenerate_triangles, 0) << seed;
    EXPECT_EQ(twice->report.flipped_triangles, 0) << seed;
    EXPECT_EQ(twice->report.inconsistent_edges, once->report.inconsistent_edges) << seed;
    EXPECT_EQ(twice->report.boundary_edges, once->report.boundary_edges) << seed;
    EXPECT_EQ(twice->mesh_B.triangles, once->mesh_B.triangles) << seed;
  }
}

TEST(PrepareSurface, ManyCavitiesAreAboutAsQuickAsNone) {
  // Bone from CT has thousands: a test of every triangle for each of them would take minutes.
  const auto seconds_with = [](bool cavities) {
    TriangleMesh mesh = test::make_icosphere(100, 6);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> in(-50, 50);
    for (int n = 0; n < 1000; ++n) {
      TriangleMesh speck = test::make_icosphere(0.1, 0, Vec3(in(random), in(random), in(random)));
      if (cavities) speck = test::turn_inside_out(speck);
      const auto offset = std::int32_t(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), speck.vertices.begin(), speck.vertices.end());
      for (const auto& [a, b, c] : speck.triangles)
        mesh.triangles.push_back({a + offset, b + offset, c + offset});
    }
    const auto start = std::chrono::steady_clock::now();
    expect_report(prepare_surface(mesh).value(), {});
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double none = seconds_with(false);
  EXPECT_LT(seconds_with(true), 10 * none + 0.2);
}

TEST(PrepareSurface, RejectsInvalidSurfaces) {
  const auto complaint = [](const TriangleMesh& mesh) {
    const auto surface = prepare_surface(mesh);
    if (surface) return std::string("accepted");
    EXPECT_EQ(surface.error().code, ErrorCode::kMeshInvalid);
    return surface.error().message;
  };
  EXPECT_NE(complaint({}).find("no triangle"), std::string::npos);
  TriangleMesh bad = kTorus;
  bad.vertices[7].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint(bad).find("vertex 7"), std::string::npos);
  bad = kTorus;
  bad.vertices[3].z() = 1e7;
  EXPECT_NE(complaint(bad).find("vertex 3"), std::string::npos);
  bad = kTorus;
  bad.triangles[2][1] = -1;
  EXPECT_NE(complaint(bad).find("triangle 2"), std::string::npos);
  TriangleMesh point;
  point.vertices.assign(3, Vec3(1, 2, 3));
  point.triangles = {{0, 1, 2}};
  EXPECT_NE(complaint(point).find("points or lines"), std::string::npos);
}

}  // namespace
}  // namespace lefort::field::test_prepare_surface
