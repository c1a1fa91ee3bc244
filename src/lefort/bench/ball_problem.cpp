#include <lefort/bench/ball_problem.h>
#include <lefort/bench/unit_sphere.h>
#include <lefort/core/check.h>
#include <lefort/mesh/box_grid.h>

#include <numbers>

namespace lefort::bench {
namespace {

geometry::TriangleMesh unit_icosahedron() {
  const double t = std::numbers::phi;
  geometry::TriangleMesh ball;
  ball.vertices = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                   {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  ball.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vec3& v : ball.vertices) v.normalize();
  return ball;
}

}  // namespace

mesh::VolumeMesh BallProblem::block() {
  return mesh::make_box(mesh::ElementShape::kHex8, {16, 16, 8}, Vec3(40.0, 40.0, 20.0));
}

geometry::TriangleMesh BallProblem::ball(int halvings) {
  constexpr int kMaxHalvings = 6;
  LEFORT_CHECK(halvings >= 0 && halvings <= kMaxHalvings);
  geometry::TriangleMesh ball = unit_icosahedron();
  for (int n = 0; n < halvings; ++n) halve_edges(ball);
  for (Vec3& v : ball.vertices) v = center_mm() + kRadius_mm * v;
  return ball;
}

geometry::RigidPath BallProblem::path() {
  constexpr int kIncrements = kPressIncrements + kSlideIncrements;
  return {.segment = "ball",
          .keyframes = {{.path_fraction = double(kPressIncrements) / kIncrements,
                         .translation_mm = {0.0, 0.0, -kPressed_mm}},
                        {.path_fraction = 1.0, .translation_mm = {kSlid_mm, 0.0, -kPressed_mm}}},
          .steps = kIncrements};
}

}  // namespace lefort::bench
