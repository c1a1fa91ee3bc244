#include <lefort/geometry/pseudonormals.h>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace lefort::geometry::test_pseudonormals {
namespace {

TEST(Pseudonormals, CornersOfABoxPointAlongTheDiagonalForAnyTriangulationOfTheFaces) {
  // Corners 0 and 7 have one, two and two triangles on their faces; weighting by angles
  // compensates.
  const TriangleMesh box = test::make_box(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  const Pseudonormals normals(box);
  for (std::size_t v = 0; v < box.vertices.size(); ++v)
    EXPECT_LT((normals.at_vertex(box, Index(v)) - box.vertices[v].normalized()).norm(), 1e-14);
}

TEST(Pseudonormals, EdgesSumTheNormalsOfTheirFaces) {
  const TriangleMesh box = test::make_box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const Pseudonormals normals(box);
  int box_edges = 0;  // Each counted from both sides.
  for (Index t = 0; t < box.triangle_count(); ++t)
    for (const Feature edge : {Feature::kEdge0, Feature::kEdge1, Feature::kEdge2}) {
      const double squared = normals.at(box, t, edge).squaredNorm();
      EXPECT_TRUE(std::abs(squared - 2.0) < 1e-12 || std::abs(squared - 4.0) < 1e-12);
      if (std::abs(squared - 2.0) < 1e-12) ++box_edges;
    }
  EXPECT_EQ(box_edges, 24);
}

TEST(Pseudonormals, FeaturesOfATriangleUseTheNumbersOfThatTriangle) {
  const TriangleMesh box = test::make_box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const Pseudonormals normals(box);
  // Triangle 0 is (0, 2, 3) in the face z = 0; its edge 0 lies on the edge with x = 0.
  EXPECT_EQ(normals.at(box, 0, Feature::kFace), Vec3(0, 0, -1));
  EXPECT_EQ(normals.at(box, 0, Feature::kEdge0), Vec3(-1, 0, -1));
  EXPECT_EQ(normals.at(box, 0, Feature::kEdge2), Vec3(0, 0, -2));
  EXPECT_LT((normals.at(box, 0, Feature::kVertex2) - Vec3(1, 1, -1).normalized()).norm(), 1e-14);
}

TEST(Pseudonormals, ACapOnASharpEdgeTakesTheNormalBeyondIt) {
  const TriangleMesh box = test::make_box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const TriangleMesh capped = test::with_cap(box, 0, 0);  // On the rim x = z = 0.
  const Pseudonormals normals(capped);
  const auto middle = capped.vertices.size() - 1;
  EXPECT_LT((normals.at_vertex(capped, Index(middle)) - Vec3(-1, 0, -1).normalized()).norm(),
            1e-14);
  const Index cap = capped.triangle_count() - 1;
  EXPECT_TRUE(normals.at(capped, cap, Feature::kFace).isZero());
  for (const Feature edge : {Feature::kEdge0, Feature::kEdge1, Feature::kEdge2})
    EXPECT_LT((normals.at(capped, cap, edge) - Vec3(-1, 0, -1)).norm(), 1e-14);
}

TEST(Pseudonormals, DegenerateTrianglesAloneGiveZeroNotNan) {
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  line.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 0, 1}, {3, 3, 3}};
  const Pseudonormals normals(line);
  for (Index t = 0; t < line.triangle_count(); ++t)
    for (int feature = 0; feature < 7; ++feature)
      EXPECT_TRUE(normals.at(line, t, Feature(feature)).isZero());
}

TEST(Pseudonormals, RotateWithTheSurface) {
  const TriangleMesh spike = test::make_spike(1, 4, 7);
  const RigidTransform X(Eigen::Translation3d(5, -3, 2) *
                         Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()));
  const Pseudonormals still(spike);
  const TriangleMesh moved = test::moved(spike, X);
  const Pseudonormals turned(moved);
  for (std::size_t v = 0; v < spike.vertices.size(); ++v)
    EXPECT_LT(
        (turned.at_vertex(moved, Index(v)) - X.linear() * still.at_vertex(spike, Index(v))).norm(),
        1e-12);
}

}  // namespace
}  // namespace lefort::geometry::test_pseudonormals
