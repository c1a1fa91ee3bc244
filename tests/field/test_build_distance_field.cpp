#include <lefort/core/parallel.h>
#include <lefort/field/build_distance_field.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_measures.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "support/shapes.h"

namespace lefort::field {
namespace {

using geometry::TriangleMesh;

const TriangleMesh kTorus = test::make_torus(20, 8, 60, 30);

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

bool same_bits(const DistanceField& a, const DistanceField& b) {
  return a.octree().codes() == b.octree().codes() &&
         same_bits(a.octree().samples(), b.octree().samples()) &&
         same_bits(a.smooth_lattice().values(), b.smooth_lattice().values()) &&
         a.frame().origin_B == b.frame().origin_B && a.cell_mm() == b.cell_mm();
}

TEST(BuildDistanceField, SameBitsForAnyNumberOfThreads) {
  const auto build_with = [](int threads) {
    const ThreadLimit limit(threads);
    return build_distance_field(kTorus, {.resolution = 64}).value();
  };
  const DistanceField one = build_with(1);
  EXPECT_TRUE(same_bits(one, build_with(2)));
  EXPECT_TRUE(same_bits(one, build_with(5)));
}

TEST(BuildDistanceField, ASoupOfTrianglesIsAsGoodAsTheSurface) {
  const auto welded = build_distance_field(kTorus, {.resolution = 32});
  const auto soup = build_distance_field(test::unwelded(kTorus), {.resolution = 32});
  ASSERT_TRUE(soup);
  EXPECT_TRUE(soup->frame().closed);
  ASSERT_EQ(soup->octree().codes(), welded->octree().codes());
  for (std::size_t s = 0; s < soup->octree().samples().size(); ++s)
    EXPECT_NEAR(soup->octree().samples()[s], welded->octree().samples()[s], 1e-5);
}

TEST(BuildDistanceField, AMovedSurfaceHasTheMovedField) {
  const TriangleMesh torus = test::make_torus(20, 8, 120, 60);
  const RigidTransform shift(Eigen::Translation3d(64, -128, 32));  // Exact in floating point.
  const RigidTransform turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const DistanceFieldOptions options{.resolution = 64, .band_mm = 5.0, .tolerance_mm = 0.001};
  const auto still = build_distance_field(torus, options);
  const auto shifted = build_distance_field(test::moved(torus, shift), options);
  const auto turned = build_distance_field(test::moved(torus, turn), options);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi), radius(5, 11);
  for (int n = 0; n < 1000; ++n) {
    const double u = angle(random), v = angle(random), r = radius(random);
    const Vec3 p((20 + r * std::cos(v)) * std::cos(u), (20 + r * std::cos(v)) * std::sin(u),
                 r * std::sin(v));
    const SmoothSample sample = still->sample_smooth(p);
    EXPECT_NEAR(shifted->sample_smooth(shift * p).distance_mm, sample.distance_mm, 1e-5);
    EXPECT_NEAR(turned->sample_smooth(turn * p).distance_mm, sample.distance_mm, 0.02);
    EXPECT_LT(
        (turned->sample_smooth(turn * p).gradient_B - turn.linear() * sample.gradient_B).norm(),
        0.06);
  }
}

TEST(BuildDistanceField, ABoneThinnerThanACellKeepsBothSidesOutside) {
  const TriangleMesh plate = test::make_box(Vec3(-10, -10, -0.1), Vec3(10, 10, 0.1));
  const auto field = build_distance_field(plate, {.resolution = 32, .tolerance_mm = 0.0});
  ASSERT_TRUE(field);
  ASSERT_GT(field->cell_mm(), 0.6);
  const geometry::Bvh bvh(plate);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> across(-9, 9), off(-1.8, 1.8);
  for (int n = 0; n < 3000; ++n) {
    const Vec3 p(across(random), across(random), off(random));
    const FieldSample sample = field->sample(p);
    ASSERT_EQ(sample.zone, Zone::kBand);
    if (std::abs(p.z()) > field->cell_mm()) {
      EXPECT_GT(sample.distance_mm, 0.0);
    }
    EXPECT_NEAR(sample.distance_mm, bvh.signed_distance(p).distance_mm, 0.55 * field->cell_mm());
  }
}

TEST(BuildDistanceField, ALayerOfTwoCellsIsInside) {
  const auto field = build_distance_field(test::make_box(Vec3(-10, -10, -0.8), Vec3(10, 10, 0.8)),
                                          {.resolution = 32, .tolerance_mm = 0.0});
  EXPECT_LT(field->sample(Vec3(1, 2, 0)).distance_mm, -0.4);
}

TEST(BuildDistanceField, AnOpenSheetHasSidesInTheBandAndNoneBeyond) {
  const TriangleMesh sheet = test::make_sheet(20, 4);
  const auto field = build_distance_field(sheet, {.resolution = 32, .tolerance_mm = 0.0});
  ASSERT_TRUE(field);
  EXPECT_FALSE(field->frame().closed);
  EXPECT_NEAR(field->sample(Vec3(3, 4, 1)).distance_mm, 1.0, 1e-5);
  EXPECT_NEAR(field->sample(Vec3(3, 4, -1)).distance_mm, -1.0, 1e-5);
  EXPECT_EQ(field->sample(Vec3(3, 4, 9)).zone, Zone::kUnknown);
  EXPECT_EQ(field->sample(Vec3(3, 4, -9)).zone, Zone::kUnknown);
  EXPECT_EQ(field->sample(Vec3(30, 0, 0)).zone, Zone::kUnknown);
}

TEST(BuildDistanceField, NoFalseSurfaceAppearsBehindTheRimOfAnOpenSheet) {
  // The sign jumps there; interpolating between +d and -d would show a surface at 0.
  const TriangleMesh sheet = test::make_sheet(20, 4);
  const auto field = build_distance_field(sheet, {.resolution = 64, .tolerance_mm = 0.0});
  const geometry::Bvh bvh(sheet);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-9, 9), out(10, 11.5), off(-1, 1);
  int unknown = 0;
  for (int n = 0; n < 5000; ++n) {
    const Vec3 p(out(random), along(random), off(random));
    const double exact = bvh.closest_point(p)->distance_mm;
    for (const auto& [zone, distance] :
         {std::pair(field->sample(p).zone, field->sample(p).distance_mm),
          std::pair(field->sample_smooth(p).zone, field->sample_smooth(p).distance_mm)}) {
      if (zone == Zone::kUnknown) ++unknown;
      if (zone != Zone::kBand) continue;
      EXPECT_NEAR(std::abs(distance), exact, 0.9 * field->cell_mm());
    }
  }
  EXPECT_GT(unknown, 100);
}

TEST(BuildDistanceField, AcceptsASurfaceThatIsNoManifold) {
  const TriangleMesh two = test::join(test::make_box(Vec3(0, 0, 0), Vec3(5, 5, 5)),
                                      test::make_box(Vec3(5, 5, 0), Vec3(10, 10, 5)));
  const auto field = build_distance_field(two, {.resolution = 32});
  ASSERT_TRUE(field);
  EXPECT_TRUE(field->frame().closed);
  EXPECT_LT(field->sample(Vec3(2, 2, 2)).distance_mm, 0.0);
  EXPECT_LT(field->sample(Vec3(8, 8, 2)).distance_mm, 0.0);
  EXPECT_GT(field->sample(Vec3(6, 4, 2)).distance_mm, 0.0);
}

TEST(BuildDistanceField, TheBandFitsIntoTheBox) {
  const auto three_cells = build_distance_field(kTorus, {.resolution = 64});
  EXPECT_DOUBLE_EQ(three_cells->band_mm(), 3.0 * three_cells->cell_mm());
  const auto asked = build_distance_field(kTorus, {.resolution = 64, .band_mm = 6, .margin_mm = 2});
  EXPECT_EQ(asked->band_mm(), 6.0);
  EXPECT_NEAR(asked->box_B().sizes().x(), 56 + 2 * (6 + 2), 1e-9);
  EXPECT_TRUE(asked->box_B().contains(geometry::bounding_box(kTorus)));
}

TEST(BuildDistanceField, WorksAtTheSmallestResolution) {
  const auto field = build_distance_field(kTorus, {.resolution = 16});
  ASSERT_TRUE(field) << field.error().message;
  EXPECT_LT(field->sample(Vec3(20, 0, 0)).distance_mm, 0.0);
  EXPECT_LT(field->sample_smooth(Vec3(20, 0, 0)).distance_mm, 0.0);
}

std::string refusal(const TriangleMesh& mesh, const DistanceFieldOptions& options, ErrorCode code) {
  const auto field = build_distance_field(mesh, options);
  if (field) return "accepted";
  EXPECT_EQ(field.error().code, code);
  return field.error().message;
}

TEST(BuildDistanceField, RefusesOptionsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto names = [](const DistanceFieldOptions& options, const char* name) {
    return refusal(kTorus, options, ErrorCode::kInvalidArgument).starts_with(name);
  };
  for (const int resolution : {-64, 0, 8, 48, 2048})
    EXPECT_TRUE(names({.resolution = resolution}, "resolution is"));
  for (const double bad : {-1.0, nan, 1e9}) {
    EXPECT_TRUE(names({.band_mm = bad}, "band_mm is"));
    EXPECT_TRUE(names({.tolerance_mm = bad}, "tolerance_mm is"));
    EXPECT_TRUE(names({.margin_mm = bad}, "margin_mm is"));
  }
  EXPECT_TRUE(names({.resolution = 64, .band_mm = 0.5}, "band_mm is 0.5"));  // Under two cells.
  EXPECT_TRUE(names({.resolution = 64, .band_mm = 100}, "band_mm is 100"));
}

TEST(BuildDistanceField, RefusesSurfacesThatAreNone) {
  const auto complaint = [](const TriangleMesh& mesh) {
    return refusal(mesh, {.resolution = 16}, ErrorCode::kMeshInvalid);
  };
  EXPECT_NE(complaint({}).find("no triangle"), std::string::npos);
  TriangleMesh nan = kTorus;
  nan.vertices[7].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint(nan).find("vertex 7"), std::string::npos);
  TriangleMesh point;
  point.vertices.assign(3, Vec3(1, 2, 3));
  point.triangles = {{0, 1, 2}};
  EXPECT_NE(complaint(point).find("points or lines"), std::string::npos);
  TriangleMesh huge = test::make_sheet(1, 1);
  huge.triangles.resize(20'000'001, huge.triangles[0]);
  EXPECT_NE(complaint(huge).find("at most 20000000"), std::string::npos);
  EXPECT_NE(complaint(test::make_icosphere(1e-5, 1)).find("wide"), std::string::npos);
  EXPECT_NE(complaint(test::turn_inside_out(kTorus)).find("clockwise"), std::string::npos);
}

TEST(BuildDistanceField, ALineOfTrianglesWithoutAreaIsStillMeasured) {
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {5, 0, 0}, {10, 0, 0}};
  line.triangles = {{0, 1, 2}};
  const auto field = build_distance_field(line, {.resolution = 32});
  ASSERT_TRUE(field);
  EXPECT_NEAR(field->sample(Vec3(5, 0.8, 0)).distance_mm, 0.8, 0.1);
}

class StopAt : public Progress {
 public:
  explicit StopAt(int reports) : left_(reports) {}
  void report(double fraction) override {
    EXPECT_GE(fraction, 0.0);
    EXPECT_LE(fraction, 1.0);
    --left_;
  }
  [[nodiscard]] bool stop_requested() const override { return left_ <= 0; }

 private:
  int left_;
};

TEST(BuildDistanceField, StopsWhenAsked) {
  for (const int reports : {0, 1, 19, 20}) {
    StopAt progress(reports);
    const auto field = build_distance_field(kTorus, {.resolution = 64}, progress);
    ASSERT_FALSE(field);
    EXPECT_EQ(field.error().code, ErrorCode::kCancelled);
  }
}

}  // namespace
}  // namespace lefort::field
