#include <lefort/core/parallel.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace lefort::field::test_build_distance_field {
namespace {

using geometry::TriangleMesh;

const TriangleMesh kTorus = test::make_torus(20, 8, 60, 30);

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

template <class T>
bool same_bits(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

bool same_bits(const BrickSamples& a, const BrickSamples& b) {
  return same_bits(a.bricks(), b.bricks()) && same_bits(a.codes(), b.codes());
}
bool same_bits(const Octree& a, const Octree& b) {
  return a.codes() == b.codes() && same_bits(a.samples(), b.samples());
}
bool same_bits(const DenseSamples& a, const DenseSamples& b) {
  return same_bits(std::span<const float>(a.values()), std::span<const float>(b.values()));
}

bool same_bits(const DistanceField& a, const DistanceField& b) {
  const bool same_samples = std::visit(
      [&](const auto& samples) {
        return same_bits(samples, std::get<std::decay_t<decltype(samples)>>(b.samples()));
      },
      a.samples());
  return same_samples && same_bits(a.smooth_lattice()->values(), b.smooth_lattice()->values()) &&
         a.frame().origin_B == b.frame().origin_B && a.cell_mm() == b.cell_mm();
}

TEST(BuildDistanceField, SameBitsForAnyNumberOfThreads) {
  for (const FieldMethod method : kMethods) {
    const auto build_with = [&](int threads) {
      const ThreadLimit limit(threads);
      return build_distance_field(kTorus, {.method = method, .resolution = 64, .smooth = true})
          .value();
    };
    const DistanceField one = build_with(1);
    EXPECT_TRUE(same_bits(one, build_with(2))) << int(method);
    EXPECT_TRUE(same_bits(one, build_with(5))) << int(method);
  }
}

TEST(BuildDistanceField, ATriangleSoupGivesTheFieldOfTheSurface) {
  for (const FieldMethod method : kMethods) {
    const DistanceFieldOptions options{.method = method, .resolution = 32};
    const auto welded = build_distance_field(kTorus, options);
    const auto soup = build_distance_field(test::unwelded(kTorus), options);
    ASSERT_TRUE(soup);
    EXPECT_TRUE(soup->frame().closed);
    for (int c = 0; c < 32 * 32 * 32; ++c) {
      const LatticePoint low = {c % 32, c / 32 % 32, c / 1024};
      const CellSamples a = welded->cell(low), b = soup->cell(low);
      ASSERT_EQ(a.cells, b.cells);
      ASSERT_EQ(zone_of(a.corners), zone_of(b.corners));
      if (zone_of(a.corners) != Zone::kBand) continue;
      for (std::size_t corner = 0; corner < 8; ++corner)
        ASSERT_NEAR(a.corners[corner], b.corners[corner], 1e-5);
    }
  }
}

TEST(BuildDistanceField, ATranslatedSurfaceHasTheTranslatedField) {
  const TriangleMesh torus = test::make_torus(20, 8, 120, 60);
  const RigidTransform shift(Eigen::Translation3d(64, -128, 32));  // Exact in floating point.
  const RigidTransform turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const DistanceFieldOptions options{.resolution = 64, .band_mm = 5.0, .smooth = true};
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

TEST(BuildDistanceField, BothSidesOfABoneThinnerThanACellAreOutside) {
  const TriangleMesh plate = test::make_box(Vec3(-10, -10, -0.1), Vec3(10, 10, 0.1));
  for (const FieldMethod method : kMethods) {
    const auto field =
        build_distance_field(plate, {.method = method, .resolution = 32, .tolerance_mm = 0.0});
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
}

TEST(BuildDistanceField, ALayerOfTwoCellsIsInside) {
  const auto field = build_distance_field(test::make_box(Vec3(-10, -10, -0.8), Vec3(10, 10, 0.8)),
                                          {.resolution = 32, .band_mm = 3 * 20.0 / 26});
  ASSERT_NEAR(field->cell_mm(), 0.77, 0.01);
  EXPECT_LT(field->sample(Vec3(1, 2, 0)).distance_mm, -0.4);
}

TEST(BuildDistanceField, AnOpenSheetHasSignsInTheBandOnly) {
  const TriangleMesh sheet = test::make_sheet(20, 4);
  for (const FieldMethod method : kMethods) {
    const auto field =
        build_distance_field(sheet, {.method = method, .resolution = 32, .tolerance_mm = 0.0});
    ASSERT_TRUE(field);
    EXPECT_FALSE(field->frame().closed);
    EXPECT_NEAR(field->sample(Vec3(3, 4, 1)).distance_mm, 1.0, 1e-5);
    EXPECT_NEAR(field->sample(Vec3(3, 4, -1)).distance_mm, -1.0, 1e-5);
    EXPECT_EQ(field->sample(Vec3(3, 4, 9)).zone, Zone::kUnknown);
    EXPECT_EQ(field->sample(Vec3(3, 4, -9)).zone, Zone::kUnknown);
    EXPECT_EQ(field->sample(Vec3(30, 0, 0)).zone, Zone::kUnknown);
  }
}

TEST(BuildDistanceField, NoFalseSurfaceAppearsBeyondTheBoundaryOfAnOpenSheet) {
  // The sign jumps there; interpolation between +d and -d would give a surface at 0.
  const TriangleMesh sheet = test::make_sheet(20, 4);
  const geometry::Bvh bvh(sheet);
  for (const FieldMethod method : kMethods) {
    const auto field = build_distance_field(
        sheet, {.method = method, .resolution = 64, .tolerance_mm = 0.0, .smooth = true});
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
}

TEST(BuildDistanceField, AcceptsANonManifoldSurface) {
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
  const auto five_cells = build_distance_field(kTorus, {.resolution = 64});
  EXPECT_DOUBLE_EQ(five_cells->band_mm(), 5.0 * five_cells->cell_mm());
  EXPECT_NEAR(five_cells->box_B().sizes().x(), 56 + 2 * five_cells->band_mm(), 1e-9);
  const auto requested =
      build_distance_field(kTorus, {.resolution = 64, .band_mm = 6, .margin_mm = 2});
  EXPECT_EQ(requested->band_mm(), 6.0);
  EXPECT_NEAR(requested->box_B().sizes().x(), 56 + 2 * (6 + 2), 1e-9);
  EXPECT_TRUE(requested->box_B().contains(geometry::bounding_box(kTorus)));
}

TEST(BuildDistanceField, TheEdgeOfTheCubeCanBeGiven) {
  const auto field = build_distance_field(kTorus, {.resolution = 64, .side_mm = 96});
  EXPECT_DOUBLE_EQ(field->cell_mm(), 1.5);
  EXPECT_DOUBLE_EQ(field->band_mm(), 7.5);
  EXPECT_LT((field->box_B().center() - geometry::bounding_box(kTorus).center()).norm(), 1e-9);
  EXPECT_NEAR(field->box_B().sizes().y(), 96, 1e-9);
}

TEST(BuildDistanceField, WorksAtTheSmallestResolution) {
  for (const FieldMethod method : kMethods) {
    const auto field =
        build_distance_field(kTorus, {.method = method, .resolution = 16, .smooth = true});
    ASSERT_TRUE(field) << field.error().message;
    EXPECT_LT(field->sample(Vec3(20, 0, 0)).distance_mm, 0.0);
    EXPECT_LT(field->sample_smooth(Vec3(20, 0, 0)).distance_mm, 0.0);
  }
}

TEST(BuildDistanceField, WorksAtTheLargestResolution) {
  // A small part in a large cube: only the table grows.
  const auto field =
      build_distance_field(test::make_icosphere(1, 3), {.resolution = 2048, .side_mm = 40.96});
  ASSERT_TRUE(field) << field.error().message;
  EXPECT_NEAR(field->sample(Vec3(0, 0, 1.05)).distance_mm, 0.05, 0.01);
  EXPECT_EQ(field->sample(Vec3(0, 0, 0)).zone, Zone::kInside);
  EXPECT_EQ(field->sample(Vec3(20, 20, 20)).zone, Zone::kOutside);
}

TEST(BuildDistanceField, AnInwardSurfaceIsFlipped) {
  for (const FieldMethod method : kMethods) {
    const auto field =
        build_distance_field(test::turn_inside_out(kTorus), {.method = method, .resolution = 32});
    ASSERT_TRUE(field) << field.error().message;
    EXPECT_LT(field->sample(Vec3(20, 0, 0)).distance_mm, 0.0);
    EXPECT_GT(field->sample(Vec3(0, 0, 0)).distance_mm, 0.0);
  }
}

class Notes : public Progress {
 public:
  void note(std::string_view sentence) override { sentences.emplace_back(sentence); }
  std::vector<std::string> sentences;
};

TEST(BuildDistanceField, ReportsItsRepairs) {
  Notes clean;
  ASSERT_TRUE(build_distance_field(kTorus, {.resolution = 16}, clean));
  EXPECT_TRUE(clean.sentences.empty());
  TriangleMesh mesh = kTorus;
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  mesh.triangles.push_back(mesh.triangles[9]);
  Notes notes;
  ASSERT_TRUE(build_distance_field(mesh, {.resolution = 16}, notes));
  EXPECT_EQ(notes.sentences, (std::vector<std::string>{"1 triangle dropped as redundant",
                                                       "1 triangle flipped to face outward"}));
}

std::string refusal(const TriangleMesh& mesh, const DistanceFieldOptions& options, ErrorCode code) {
  const auto field = build_distance_field(mesh, options);
  if (field) return "accepted";
  EXPECT_EQ(field.error().code, code);
  return field.error().message;
}

TEST(BuildDistanceField, RejectsOptionsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto names = [](const DistanceFieldOptions& options, const char* name) {
    return refusal(kTorus, options, ErrorCode::kInvalidArgument).starts_with(name);
  };
  for (const int resolution : {-64, 0, 8, 48, 4096})
    EXPECT_TRUE(names({.resolution = resolution}, "resolution is"));
  EXPECT_TRUE(names({.method = FieldMethod::kUniform, .resolution = 2048}, "resolution is 2048"));
  for (const double bad : {-1.0, nan, 1e9}) {
    EXPECT_TRUE(names({.band_mm = bad}, "band_mm is"));
    EXPECT_TRUE(names({.tolerance_mm = bad}, "tolerance_mm is"));
    EXPECT_TRUE(names({.margin_mm = bad}, "margin_mm is"));
    EXPECT_TRUE(names({.side_mm = bad}, "side_mm is"));
  }
  EXPECT_TRUE(names({.resolution = 64, .band_mm = 0.5}, "band_mm is 0.5"));  // Less than two cells.
  EXPECT_TRUE(names({.resolution = 64, .band_mm = 100}, "band_mm is 100"));
  EXPECT_TRUE(names({.resolution = 64, .side_mm = 60}, "side_mm is 60"));  // No room for the band.
}

TEST(BuildDistanceField, RejectsInvalidSurfaces) {
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
  huge.triangles.resize(100'000'001);
  EXPECT_NE(complaint(huge).find("at most 100000000"), std::string::npos);
  EXPECT_NE(complaint(test::make_icosphere(1e-5, 1)).find("wide"), std::string::npos);
}

TEST(BuildDistanceField, AcceptsALineOfTrianglesWithoutArea) {
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {5, 0, 0}, {10, 0, 0}};
  line.triangles = {{0, 1, 2}};
  const auto field = build_distance_field(line, {.resolution = 32});
  ASSERT_TRUE(field);
  EXPECT_NEAR(field->sample(Vec3(5, 0.8, 0)).distance_mm, 0.8, 0.1);
}

/// Stops at the n-th request.
class StopAt : public Progress {
 public:
  explicit StopAt(int times) : left_(times) {}
  void report(double fraction) override {
    EXPECT_GE(fraction, 0.0);
    EXPECT_LE(fraction, 1.0);
  }
  [[nodiscard]] bool stop_requested() const override { return left_.fetch_sub(1) <= 0; }
  [[nodiscard]] int left() const { return left_; }

 private:
  mutable std::atomic<int> left_;
};

TEST(BuildDistanceField, StopsAtAnyRequest) {
  constexpr int kMany = 1 << 20;
  for (const FieldMethod method : kMethods) {
    const DistanceFieldOptions options{.method = method, .resolution = 64, .smooth = true};
    StopAt never(kMany);
    ASSERT_TRUE(build_distance_field(kTorus, options, never));
    const int requested = kMany - never.left();
    EXPECT_GE(requested, 4) << int(method);
    for (int times = 0; times < requested; times += 1 + requested / 12) {
      StopAt progress(times);
      const auto field = build_distance_field(kTorus, options, progress);
      ASSERT_FALSE(field) << int(method) << ": " << times << " of " << requested;
      EXPECT_EQ(field.error().code, ErrorCode::kCancelled);
    }
  }
}

TEST(BuildDistanceField, RejectsABandThatWouldFillTheMemory) {
  // Large slanted triangles; the box of each contains an eighth of a large lattice.
  geometry::TriangleMesh fan;
  fan.vertices.emplace_back(0, 0, 0);
  for (int n = 0; n <= 3000; ++n)
    fan.vertices.emplace_back(100 * std::cos(0.002 * n), 100 * std::sin(0.002 * n),
                              100 + 0.006 * n);
  for (std::int32_t n = 1; n <= 3000; ++n) fan.triangles.push_back({0, n, n + 1});
  for (const FieldMethod method : {FieldMethod::kBricks, FieldMethod::kHybrid}) {
    const auto field = build_distance_field(fan, {.method = method, .resolution = 2048});
    ASSERT_FALSE(field);
    EXPECT_EQ(field.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(field.error().message.find("lower the resolution or the band"), std::string::npos);
  }
}

}  // namespace
}  // namespace lefort::field::test_build_distance_field
