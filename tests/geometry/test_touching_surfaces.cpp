/// \file
/// The sign of the pseudonormal where surfaces touch themselves: vertices with several fans of
/// triangles, edges with four triangles.
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "support/shapes.h"

namespace lefort::geometry::test_touching_surfaces {
namespace {

constexpr int kSide = 3;

/// Which cubes of a grid of kSide^3 are filled; cubes outside it are empty.
struct Blocks {
  std::vector<bool> filled;

  [[nodiscard]] bool at(int x, int y, int z) const {
    for (const int c : {x, y, z})
      if (c < 0 || c >= kSide) return false;
    return filled[std::size_t((z * kSide + y) * kSide + x)];
  }
};

/// The surface between filled and empty cubes; its corners touch in all possible ways.
TriangleMesh surface_of(const Blocks& blocks) {
  TriangleMesh mesh;
  for (int z = -1; z <= kSide; ++z)
    for (int y = -1; y <= kSide; ++y)
      for (int x = -1; x <= kSide; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const Vec3 low(x, y, z), next = Vec3::Unit(axis);
          const bool here = blocks.at(x, y, z),
                     there = blocks.at(x + int(next[0]), y + int(next[1]), z + int(next[2]));
          if (here == there) continue;
          const Vec3 u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
          const auto first = std::int32_t(mesh.vertices.size());
          for (const Vec3& p : {Vec3(0, 0, 0), u, Vec3(u + v), v})
            mesh.vertices.push_back(low + next + p);
          if (here) {
            mesh.triangles.push_back({first, first + 1, first + 2});
            mesh.triangles.push_back({first, first + 2, first + 3});
          } else {
            mesh.triangles.push_back({first, first + 2, first + 1});
            mesh.triangles.push_back({first, first + 3, first + 2});
          }
        }
  return weld_vertices(mesh);
}

Blocks random_blocks(std::mt19937& random) {
  Blocks blocks;
  const auto fraction = 1 + random() % 7;
  for (int n = 0; n < kSide * kSide * kSide; ++n) blocks.filled.push_back(random() % 8 < fraction);
  blocks.filled[13] = true;
  return blocks;
}

TEST(TouchingSurfaces, SignsAreRightForBlocksThatTouchAtCornersAndEdges) {
  int off_face = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> in(-0.3, kSide + 0.3);
    const Blocks blocks = random_blocks(random);
    const Bvh bvh(surface_of(blocks));
    for (int n = 0; n < 500; ++n) {
      Vec3 p(in(random), in(random), in(random));
      // Half of the points lie on planes of symmetry, where several features are equally close.
      if (n % 2 == 0) p = (p * 4.0).array().floor() / 4.0 + 0.125;
      const SignedDistance found = bvh.signed_distance(p);
      off_face += found.nearest.feature != Feature::kFace ? 1 : 0;
      ASSERT_EQ(found.distance_mm < 0.0,
                blocks.at(int(std::floor(p.x())), int(std::floor(p.y())), int(std::floor(p.z()))))
          << "seed " << seed << ", at " << p.transpose();
    }
  }
  EXPECT_GT(off_face, 10'000);
}

TEST(TouchingSurfaces, SignsAreRightForBentBlocks) {
  int off_face = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> in(-0.3, kSide + 0.3), bend(-0.12, 0.12);
    TriangleMesh mesh = surface_of(random_blocks(random));
    for (Vec3& v : mesh.vertices) v += Vec3(bend(random), bend(random), bend(random));
    const Bvh bvh(mesh);
    for (int n = 0; n < 300; ++n) {
      const Vec3 p(in(random), in(random), in(random));
      const SignedDistance found = bvh.signed_distance(p);
      off_face += is_vertex(found.nearest.feature) ? 1 : 0;
      ASSERT_EQ(found.distance_mm<0.0, winding_number(mesh, p)> 0.5)
          << "seed " << seed << ", at " << p.transpose();
    }
  }
  EXPECT_GT(off_face, 3000);
}

}  // namespace
}  // namespace lefort::geometry::test_touching_surfaces
