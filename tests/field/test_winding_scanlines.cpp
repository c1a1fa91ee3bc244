#include <lefort/core/parallel.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "field/brute_force.h"
#include "support/shapes.h"
#include "support/ugly_mesh.h"

namespace lefort::field::test_winding_scanlines {
namespace {

using geometry::TriangleMesh;

/// Cube of 32 cells of 1 mm around the origin, with lattice points at whole numbers.
FieldFrame cube() {
  FieldFrame frame;
  frame.resolution = 32;
  frame.cell_mm = 1.0;
  frame.origin_B = Vec3::Constant(-16.0);
  return frame;
}

/// Compares with solid angles at all lattice points further than a cell from the surface, or at a
/// ninth of them. Other points have no valid result.
///
/// \returns the number of points inside.
Index expect_solid_angles(const TriangleMesh& mesh, const FieldFrame& frame) {
  const WindingScanlines rows(mesh, frame);
  const int step = mesh.triangle_count() > 100 ? 3 : 1;
  const geometry::Bvh bvh(mesh);
  Index inside = 0;
  for (int k = 0; k <= frame.resolution; k += step)
    for (int j = 0; j <= frame.resolution; ++j)
      for (int i = 0; i <= frame.resolution; i += step) {
        const Vec3 p = test::position_of(frame, i, j, k);
        if (bvh.closest_point(p)->distance_mm <= frame.cell_mm) continue;
        const bool expected = geometry::winding_number(mesh, p) > 0.5;
        EXPECT_EQ(rows.is_inside({i, j, k}), expected) << p.transpose();
        inside += expected ? 1 : 0;
      }
  return inside;
}

TEST(WindingScanlines, AgreeWithSolidAngles) {
  EXPECT_GT(expect_solid_angles(test::make_torus(9, 4, 30, 15), cube()), 100);
  EXPECT_GT(expect_solid_angles(test::make_crumpled_ball(3, 6, 14), cube()), 100);
}

TEST(WindingScanlines, AgreeWithSolidAnglesInAFrameWithFractionalCoordinates) {
  FieldFrame frame = cube();
  frame.cell_mm = 0.7310585786300049;
  frame.origin_B = Vec3(-11.3, -12.1, -11.9);
  EXPECT_GT(expect_solid_angles(test::make_torus(7, 3, 30, 15), frame), 100);
}

TEST(WindingScanlines, AreRightOnSurfacesThatFollowTheLattice) {
  // Faces and edges in the planes and on the lines of the lattice.
  EXPECT_EQ(expect_solid_angles(test::make_box(Vec3(-10, -8, -6), Vec3(10, 8, 6)), cube()),
            17 * 13 * 9);
  EXPECT_EQ(expect_solid_angles(test::make_capped_box(Vec3(-10, -8, -6), Vec3(10, 8, 6)), cube()),
            17 * 13 * 9);
  // Nothing is inside of an inward box.
  EXPECT_EQ(expect_solid_angles(
                test::turn_inside_out(test::make_box(Vec3(-10, -8, -6), Vec3(10, 8, 6))), cube()),
            0);
}

TEST(WindingScanlines, CountNestedShells) {
  const TriangleMesh shells = test::join(
      test::join(test::make_icosphere(14, 3), test::turn_inside_out(test::make_icosphere(10, 3))),
      test::make_icosphere(6, 2));
  expect_solid_angles(shells, cube());
  const WindingScanlines rows(shells, cube());
  EXPECT_TRUE(rows.is_inside({16, 16, 16}));  // Inside the innermost.
  EXPECT_FALSE(rows.is_inside({16 + 8, 16, 16}));
  EXPECT_TRUE(rows.is_inside({16, 16 + 12, 16}));
  EXPECT_FALSE(rows.is_inside({0, 0, 0}));
}

TEST(WindingScanlines, CountSurfacesThatIntersectOrRepeat) {
  const TriangleMesh balls = test::join(test::make_icosphere(8, 3, Vec3(-4, 0.3, 0.1)),
                                        test::make_icosphere(8, 3, Vec3(4, -0.2, 0)));
  expect_solid_angles(balls, cube());
  // The same surface twice: a winding number of two is inside.
  const TriangleMesh twice = test::join(test::make_icosphere(9, 2), test::make_icosphere(9, 2));
  EXPECT_TRUE(WindingScanlines(twice, cube()).is_inside({16, 16, 16}));
  // Once outward and once inward: zero.
  const TriangleMesh none =
      test::join(test::make_icosphere(9, 2), test::turn_inside_out(test::make_icosphere(9, 2)));
  EXPECT_FALSE(WindingScanlines(none, cube()).is_inside({16, 16, 16}));
}

TEST(WindingScanlines, NothingIsInsideBeyondTheCube) {
  const WindingScanlines rows(test::make_icosphere(15, 2), cube());
  EXPECT_TRUE(rows.is_inside({16, 16, 16}));
  for (const LatticePoint& p :
       {LatticePoint{-1, 16, 16}, LatticePoint{16, -1, 16}, LatticePoint{16, 16, -1},
        LatticePoint{33, 16, 16}, LatticePoint{16, 33, 16}, LatticePoint{16, 16, 40}})
    EXPECT_FALSE(rows.is_inside(p));
}

TEST(WindingScanlines, DoNotDependOnTheOrderOfTrianglesOrOnThreads) {
  TriangleMesh mesh = test::make_crumpled_ball(5, 5, 14);
  const WindingScanlines rows(mesh, cube());
  std::mt19937 random(1);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  for (auto& [a, b, c] : mesh.triangles) {
    const auto first = a;  // The same triangle from another first corner.
    a = b, b = c, c = first;
  }
  const ThreadLimit one(1);
  const WindingScanlines shuffled(mesh, cube());
  const geometry::Bvh bvh(mesh);
  for (int n = 0; n < 20'000; ++n) {
    const LatticePoint p = {int(random() % 33), int(random() % 33), int(random() % 33)};
    if (bvh.closest_point(test::position_of(cube(), p[0], p[1], p[2]))->distance_mm <= 1.0)
      continue;
    ASSERT_EQ(rows.is_inside(p), shuffled.is_inside(p));
  }
}

}  // namespace
}  // namespace lefort::field::test_winding_scanlines
