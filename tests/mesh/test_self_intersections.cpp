#include <lefort/mesh/self_intersections.h>

#include <gtest/gtest.h>

#include <limits>

#include "support/shapes.h"

namespace lefort::mesh::test_self_intersections {
namespace {

using geometry::TriangleMesh;

Index count(const TriangleMesh& surface) {
  const auto found = count_self_intersections(surface);
  EXPECT_TRUE(found) << found.error().message;
  return found.value_or(-1);
}

TriangleMesh with(TriangleMesh one, const TriangleMesh& other) {
  const auto first = std::int32_t(one.vertices.size());
  one.vertices.insert(one.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles)
    one.triangles.push_back({a + first, b + first, c + first});
  return one;
}

TEST(SelfIntersections, ValidSurfacesHaveNone) {
  EXPECT_EQ(count(test::make_box({0, 0, 0}, {1, 2, 3})), 0);
  EXPECT_EQ(count(test::make_icosphere(10.0, 4)), 0);
  EXPECT_EQ(count(test::make_torus(10.0, 3.0, 40, 20)), 0);
  EXPECT_EQ(count(test::make_sheet(10.0, 10)), 0);
  EXPECT_EQ(count(test::unwelded(test::make_icosphere(10.0, 3))), 0);
}

TEST(SelfIntersections, CountsTwoTrianglesByTheirContact) {
  const auto pair = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return TriangleMesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, a, b, c}, {{0, 1, 2}, {3, 4, 5}}};
  };
  EXPECT_EQ(count(pair({1, 1, -1}, {1, 1, 1}, {5, 5, 0})), 1) << "crossing";
  EXPECT_EQ(count(pair({1, 1, 0}, {1, 1, 1}, {5, 5, 1})), 1) << "touching";
  EXPECT_EQ(count(pair({1, 1, 0.001}, {1, 1, 1}, {5, 5, 1})), 0) << "just apart";
  EXPECT_EQ(count(pair({0, 0, 0}, {1, 1, 1}, {-1, 1, 1})), 0) << "one corner";
  EXPECT_EQ(count(pair({0, 0, 0}, {3, 1, 1}, {1, 3, -1})), 1) << "one corner, and across";
  EXPECT_EQ(count(pair({0, 0, 0}, {4, 0, 0}, {0, -4, 0})), 0) << "one edge";
  EXPECT_EQ(count(pair({4, 0, 0}, {0, 0, 0}, {1, 1, 0})), 1) << "folded onto the other";
  EXPECT_EQ(count(pair({0, 4, 0}, {0, 0, 0}, {4, 0, 0})), 1) << "twice";
}

TEST(SelfIntersections, CrossingBoxesHaveSome) {
  const TriangleMesh box = test::make_box({0, 0, 0}, {4, 4, 4});
  EXPECT_GT(count(with(box, test::make_box({2, 1.1, 1.3}, {6, 2.2, 2.7}))), 0);
  EXPECT_EQ(count(with(box, test::make_box({1, 1, 1}, {2, 2, 2}))), 0) << "one within the other";
  EXPECT_EQ(count(with(box, test::make_box({5, 0, 0}, {6, 2, 2}))), 0);
}

TEST(SelfIntersections, IgnoresTrianglesWithoutArea) {
  EXPECT_EQ(count(test::with_cap(test::make_icosphere(10.0, 2), 5, 1)), 0);
}

TEST(SelfIntersections, RejectsInvalidSurfaces) {
  TriangleMesh bad = test::make_box({0, 0, 0}, {1, 1, 1});
  bad.vertices[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(count_self_intersections(bad).error().code, ErrorCode::kMeshInvalid);
  EXPECT_EQ(count_self_intersections({}).error().code, ErrorCode::kMeshInvalid);
}

}  // namespace
}  // namespace lefort::mesh::test_self_intersections
