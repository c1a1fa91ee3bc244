#include <lefort/field/build/nearest_in_brick.h>
#include <lefort/geometry/closest_point.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

namespace lefort::field::test_nearest_in_brick {
namespace {

using geometry::TriangleMesh;

constexpr int kSide = SparseLattice::kSide;
constexpr double kMaxDistance_mm = 6.0;

struct Setting {
  TriangleMesh mesh;
  Vec3 low;
  double cell_mm;
};

/// Triangles of all sizes, including needles and lines, and a brick of about 7 mm.
Setting any_setting(std::mt19937& random, unsigned triangles) {
  std::uniform_real_distribution<double> in(-8, 8);
  const auto point = [&] { return Vec3(in(random), in(random), in(random)); };
  Setting s{{}, point() - Vec3::Constant(4), 0.2 + 0.1 * (in(random) + 8)};
  for (unsigned t = 0; t < triangles; ++t) {
    const Vec3 a = point();
    Vec3 b = point(), c = point();
    if (random() % 3 == 0) b = a + 0.01 * (b - a).eval();
    if (random() % 4 == 0) c = a + (0.3 + 1e-9 * in(random)) * (b - a).eval();
    const auto first = std::int32_t(s.mesh.vertices.size());
    s.mesh.vertices.insert(s.mesh.vertices.end(), {a, b, c});
    s.mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return s;
}

NearestInBrick visited(const Setting& s, Simd simd) {
  std::vector<std::int32_t> all(s.mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0);
  NearestInBrick nearest;
  nearest.clear(float(kMaxDistance_mm));
  visit_triangles(s.mesh, all, s.low, s.cell_mm, kMaxDistance_mm, simd, nearest);
  return nearest;
}

/// Position of point `i`, x fastest, in the arrays.
std::size_t at(int i) {
  return NearestInBrick::linear_offset(i % kSide, i / kSide % kSide, i / (kSide * kSide));
}

Vec3 position_of(const Setting& s, int i) {
  return s.low + s.cell_mm * Vec3(i % kSide, i / kSide % kSide, i / (kSide * kSide));
}

double distance_to(const Setting& s, Index t, const Vec3& p) {
  return std::sqrt(geometry::closest_point_on_triangle(p, s.mesh.corner(t, 0), s.mesh.corner(t, 1),
                                                       s.mesh.corner(t, 2))
                       .squared_distance_mm2);
}

TEST(NearestInBrick, EveryPointHasItsOwnPosition) {
  std::vector<int> visits(SparseLattice::kBrickPoints, 0);
  for (int i = 0; i < SparseLattice::kBrickPoints; ++i) ++visits.at(at(i));
  EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), SparseLattice::kBrickPoints);
}

TEST(NearestInBrick, IsTheNearestOfAllTriangles) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const Setting s = any_setting(random, 1 + seed % 20);  // Also incomplete batches.
    const NearestInBrick nearest = visited(s, best_simd());
    for (int i = 0; i < SparseLattice::kBrickPoints; ++i) {
      const Vec3 p = position_of(s, i);
      double minimum = 1e9;
      for (Index t = 0; t < s.mesh.triangle_count(); ++t)
        minimum = std::min(minimum, distance_to(s, t, p));
      const std::int32_t code = nearest.code[at(i)];
      if (minimum < kMaxDistance_mm - 1e-4) {
        ASSERT_NE(code, NearestInBrick::kNone) << seed;
        ASSERT_NEAR(std::sqrt(nearest.squared_mm2[at(i)]), minimum, 1e-5) << seed;
        ASSERT_NEAR(distance_to(s, NearestInBrick::triangle_of(code), p), minimum, 1e-5) << seed;
      } else if (minimum > kMaxDistance_mm + 1e-4) {
        ASSERT_EQ(code, NearestInBrick::kNone) << seed;
      }
    }
  }
}

TEST(NearestInBrick, RecordsWhetherTheFaceIsClosestAndTheSide) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const Setting s = any_setting(random, 1);
    const Vec3 &a = s.mesh.vertices[0], &b = s.mesh.vertices[1], &c = s.mesh.vertices[2];
    const bool has_area = !geometry::triangle_is_degenerate(a, b, c);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    const NearestInBrick nearest = visited(s, best_simd());
    for (int i = 0; i < SparseLattice::kBrickPoints; ++i) {
      const std::int32_t code = nearest.code[at(i)];
      if (code == NearestInBrick::kNone) continue;
      if (!has_area) {
        ASSERT_FALSE(NearestInBrick::is_face_closest(code)) << seed;
        continue;
      }
      // Away from transitions the code is right.
      const Vec3 p = position_of(s, i);
      const double height = normal.dot(p - a);
      if (std::abs(height) > 1e-4) {
        ASSERT_EQ(NearestInBrick::is_below(code), height < 0.0) << seed;
      }
      double minimum = 1e9;
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
        minimum = std::min(minimum, normal.cross(to - from).normalized().dot(p - from));
      if (std::abs(minimum) > 1e-4) {
        ASSERT_EQ(NearestInBrick::is_face_closest(code), minimum > 0.0) << seed;
      }
    }
  }
}

TEST(NearestInBrick, EveryProcessorGivesTheSameBits) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    std::mt19937 random(seed);
    const Setting s = any_setting(random, 1 + seed % 20);
    const NearestInBrick baseline = visited(s, Simd::kBaseline);
    for (const Simd simd : {Simd::kAvx2, Simd::kAvx512}) {
      if (simd > best_simd()) continue;
      const NearestInBrick other = visited(s, simd);
      EXPECT_EQ(
          std::memcmp(&other.squared_mm2, &baseline.squared_mm2, sizeof(baseline.squared_mm2)), 0)
          << seed;
      EXPECT_EQ(other.code, baseline.code) << seed;
    }
  }
}

TEST(NearestInBrick, ARepeatedTriangleChangesOnlyItsNumber) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    Setting s = any_setting(random, 9);
    const NearestInBrick once = visited(s, best_simd());
    const std::vector<geometry::Triangle> all = s.mesh.triangles;
    s.mesh.triangles.insert(s.mesh.triangles.end(), all.begin(), all.end());
    NearestInBrick twice = visited(s, best_simd());
    EXPECT_EQ(twice.squared_mm2, once.squared_mm2) << seed;
    for (std::int32_t& code : twice.code)
      if (code != NearestInBrick::kNone) code = (code >> 2) % 9 << 2 | (code & 3);
    EXPECT_EQ(twice.code, once.code) << seed;
  }
}

TEST(NearestInBrick, VisitsEveryTriangleForAnyNumberOfThem) {
  std::mt19937 random(5);
  for (int count = 1; count < 70; ++count) {
    const Setting s = any_setting(random, count);
    NearestInBrick one_by_one;
    one_by_one.clear(float(kMaxDistance_mm));
    for (std::int32_t t = 0; t < count; ++t)
      visit_triangles(s.mesh, std::span(&t, 1), s.low, s.cell_mm, kMaxDistance_mm, best_simd(),
                      one_by_one);
    EXPECT_EQ(visited(s, best_simd()).squared_mm2, one_by_one.squared_mm2) << count;
  }
}

TEST(NearestInBrick, UpdatesPreviousResults) {
  std::mt19937 random(1);
  const Setting s = any_setting(random, 12);
  NearestInBrick nearest;
  nearest.clear(float(kMaxDistance_mm));
  for (std::int32_t t = 0; t < 12; ++t)
    visit_triangles(s.mesh, std::span(&t, 1), s.low, s.cell_mm, kMaxDistance_mm, best_simd(),
                    nearest);
  const NearestInBrick together = visited(s, best_simd());
  EXPECT_EQ(nearest.code, together.code);
  EXPECT_EQ(nearest.squared_mm2, together.squared_mm2);
}

}  // namespace
}  // namespace lefort::field::test_nearest_in_brick
