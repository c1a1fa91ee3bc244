#include <lefort/contact/project_contact_to_bone.h>
#include <lefort/core/parallel.h>

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace lefort::contact::test_project_contact_to_bone {
namespace {

/// Tissue above a sheet of bone: two triangles, counter-clockwise seen from below.
struct Above {
  std::vector<Vec3> x_L;
  std::vector<mesh::Face> faces{{mesh::FaceShape::kTri3, {0, 2, 1}},
                                {mesh::FaceShape::kTri3, {1, 2, 3}}};
  std::vector<NodalContact> at_nodes;

  explicit Above(double height_mm)
      : x_L{{-10, -10, height_mm},
            {10, -10, height_mm},
            {-10, 10, height_mm},
            {10, 10, height_mm}} {
    for (std::int32_t n = 0; n < 4; ++n) {
      const Vec3& x = x_L[std::size_t(n)];
      at_nodes.push_back({.node = n,
                          .pressure_mpa = 0.02 + 0.001 * x.x() + 0.0005 * x.y(),
                          .gap_mm = height_mm,
                          .depth_mm = 0.1 + 0.01 * x.x()});
    }
  }
};

TEST(ProjectContactToBone, IsLinearBetweenTheNodesOfTheTissue) {
  const geometry::TriangleMesh bone_L = test::make_sheet(16.0, 8);
  const Above tissue(-0.05);  // A little inside.
  const BoneContactFields load =
      project_contact_to_bone(bone_L, tissue.x_L, tissue.faces, tissue.at_nodes, 0.5);
  ASSERT_EQ(load.pressure_mpa.size(), bone_L.vertices.size());
  for (std::size_t v = 0; v < bone_L.vertices.size(); ++v) {
    const Vec3& x = bone_L.vertices[v];
    EXPECT_NEAR(load.pressure_mpa[v], 0.02 + 0.001 * x.x() + 0.0005 * x.y(), 1e-12);
    EXPECT_NEAR(load.depth_mm[v], 0.1 + 0.01 * x.x(), 1e-12);
  }
}

TEST(ProjectContactToBone, IsZeroWhereTissueIsFarOrOnTheOtherSide) {
  const geometry::TriangleMesh wide_L =
      test::make_sheet(60.0, 29);  // No vertex on the boundary of the tissue.
  const Above tissue(0.3);
  const BoneContactFields load =
      project_contact_to_bone(wide_L, tissue.x_L, tissue.faces, tissue.at_nodes, 0.5);
  for (std::size_t v = 0; v < wide_L.vertices.size(); ++v) {
    const Vec3& x = wide_L.vertices[v];
    const bool is_under = std::abs(x.x()) <= 10.0 && std::abs(x.y()) <= 10.0;
    EXPECT_EQ(load.pressure_mpa[v] > 0.0, is_under) << x.transpose();
  }
  const auto sum = [&](const BoneContactFields& of) {
    double total = 0.0;
    for (const double p : of.pressure_mpa) total += p;
    return total;
  };
  EXPECT_EQ(sum(project_contact_to_bone(wide_L, tissue.x_L, tissue.faces, tissue.at_nodes, 0.2)),
            0.0);
  // On the other side of the bone the same tissue faces away from it.
  std::vector<mesh::Face> reversed = tissue.faces;
  for (mesh::Face& face : reversed) std::swap(face.nodes[1], face.nodes[2]);
  EXPECT_EQ(sum(project_contact_to_bone(wide_L, tissue.x_L, reversed, tissue.at_nodes, 0.5)), 0.0);
  EXPECT_EQ(sum(project_contact_to_bone(wide_L, tissue.x_L, {}, {}, 0.5)), 0.0);
}

TEST(ProjectContactToBone, SameBitsForAnyNumberOfThreads) {
  const geometry::TriangleMesh bone_L = test::make_sheet(16.0, 40);
  const Above tissue(-0.05);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return project_contact_to_bone(bone_L, tissue.x_L, tissue.faces, tissue.at_nodes, 0.5)
        .pressure_mpa;
  };
  EXPECT_EQ(with_threads(1), with_threads(2));
}

}  // namespace
}  // namespace lefort::contact::test_project_contact_to_bone
