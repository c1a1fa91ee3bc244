#include <lefort/core/parallel.h>
#include <lefort/report/render_surfaces.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "report/shapes.h"

namespace lefort::report::test_render_surfaces {
namespace {

using geometry::TriangleMesh;
using test::sphere;
using test::square_facing_front;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr PictureSize kSmall{200, 200, 1};
const View kFrontView{.height_mm = 100.0};  // Half a millimeter per pixel of kSmall.

class StopAtOnce final : public Progress {
 public:
  [[nodiscard]] bool stop_requested() const override { return true; }
};

Picture render(std::vector<SurfaceLayer> layers, const View& view = kFrontView,
               const PictureSize& size = kSmall) {
  return render_surfaces(layers, view, size, Progress::none()).value();
}

ErrorCode refusal(const SurfaceLayer& layer) {
  return SurfaceScene::build({&layer, 1}, Progress::none()).error().code;
}

/// The number of differing pixels, and their center.
struct Difference {
  long count = 0;
  double column = 0.0;
  double row = 0.0;
};

Difference difference(const Picture& a, const Picture& b) {
  Difference found;
  for (int row = 0; row < a.height; ++row) {
    for (int column = 0; column < a.width; ++column) {
      if (std::equal(a.pixel(column, row), a.pixel(column, row) + 4, b.pixel(column, row)))
        continue;
      ++found.count;
      found.column += column + 0.5;
      found.row += row + 0.5;
    }
  }
  found.column /= double(found.count);
  found.row /= double(found.count);
  return found;
}

int brightness(const Picture& picture, int column, int row) {
  const std::uint8_t* rgba = picture.pixel(column, row);
  return rgba[0] + rgba[1] + rgba[2];
}

TEST(RenderSurfaces, SphereCoversItsDisc) {
  const TriangleMesh ball = sphere(Vec3(5.0, 70.0, -10.0), 30.0, 60);
  const Difference disc = difference(render({{&ball}}), render({}));
  const double pixels_per_mm = 2.0;
  EXPECT_NEAR(double(disc.count), std::numbers::pi * std::pow(30.0 * pixels_per_mm, 2), 60.0);
  EXPECT_NEAR(disc.column, 100.0 + 5.0 * pixels_per_mm, 0.3);
  EXPECT_NEAR(disc.row, 100.0 + 10.0 * pixels_per_mm, 0.3);
}

TEST(RenderSurfaces, LightIsSymmetric) {
  const TriangleMesh ball = sphere(Vec3::Zero(), 40.0, 60);
  const Picture picture = render({{&ball}});
  for (int row = 0; row < 200; row += 3)
    for (int column = 0; column < 100; column += 3)
      EXPECT_NEAR(brightness(picture, column, row), brightness(picture, 199 - column, row), 24)
          << column << ", " << row;
}

TEST(RenderSurfaces, LightComesFromAbove) {
  const TriangleMesh ball = sphere(Vec3::Zero(), 40.0, 60);
  const Picture picture = render({{&ball}});
  EXPECT_GT(brightness(picture, 100, 60), brightness(picture, 100, 140) + 90);
}

TEST(RenderSurfaces, MarkerAppearsOnItsSideInEveryStandardView) {
  const TriangleMesh head = sphere(Vec3::Zero(), 50.0, 30);
  const Box3 box_L(Vec3::Constant(-65.0), Vec3::Constant(65.0));
  // A knob on the patient's left, anterior and slightly superior.
  const TriangleMesh knob = sphere(Vec3(36.0, -36.0, 15.0), 12.0, 20);
  const auto knob_in = [&](StandardView standard) {
    const View view = standard_view(standard, box_L, 1.0);
    return difference(render({{&head}, {&knob}}, view), render({{&head}}, view));
  };
  EXPECT_GT(knob_in(StandardView::kFront).column, 120.0);  // Facing the patient: to our right.
  EXPECT_LT(knob_in(StandardView::kLeftProfile).column, 80.0);
  EXPECT_NEAR(knob_in(StandardView::kLeftThreeQuarter).column, 100.0, 5.0);
  EXPECT_LT(knob_in(StandardView::kFront).row, 95.0);
  // From the right, only the part anterior to the head is visible.
  EXPECT_GT(knob_in(StandardView::kRightProfile).column, 150.0);
  EXPECT_GT(knob_in(StandardView::kRightThreeQuarter).column, 140.0);
}

TEST(RenderSurfaces, SameBitsForAnyNumberOfThreads) {
  const TriangleMesh ball = sphere(Vec3(3.0, 0.0, 1.0), 30.0, 40);
  const TriangleMesh other = sphere(Vec3(-20.0, -20.0, 1.0), 15.0, 30);
  const auto render_with = [&](int threads) {
    const ThreadLimit limit(threads);
    return render({{&ball, kBoneColor}, {.mesh_L = &other, .opacity = 0.5}});
  };
  const Picture one = render_with(1);
  EXPECT_EQ(one, render_with(2));
  EXPECT_EQ(one, render_with(5));
}

TEST(RenderSurfaces, LightOfEarlierPicturesDoesNotChangeAPicture) {
  const TriangleMesh ball = sphere(Vec3(3.0, 0.0, 1.0), 30.0, 40);
  const TriangleMesh other = sphere(Vec3(-20.0, -20.0, 1.0), 15.0, 30);
  const std::vector<SurfaceLayer> layers{{.mesh_L = &ball}, {.mesh_L = &other}};
  const SurfaceScene scene = SurfaceScene::build(layers, Progress::none()).value();
  const View side{.direction_L = {1.0, 0.2, 0.0}, .height_mm = 100.0};
  const Picture first = scene.render(side, kSmall, Progress::none()).value();
  EXPECT_EQ(scene.render(kFrontView, kSmall, Progress::none()).value(), render(layers));
  EXPECT_EQ(scene.render(side, kSmall, Progress::none()).value(), first);
}

TEST(RenderSurfaces, RecoloredSceneEqualsASceneBuiltWithThatColor) {
  const TriangleMesh ball = sphere(Vec3(3.0, 0.0, 1.0), 30.0, 40);
  const SurfaceLayer plain{.mesh_L = &ball};
  SurfaceLayer colored{.mesh_L = &ball};
  for (const Vec3& vertex_L : ball.vertices) colored.scalars.push_back(vertex_L.z());
  colored.scale = {ColorMap::kDiverging, -30.0, 30.0};
  const SurfaceScene scene = SurfaceScene::build({&plain, 1}, Progress::none()).value();
  const SurfaceScene recolored = scene.recolored(0, colored.scalars, colored.scale).value();
  EXPECT_EQ(recolored.render(kFrontView, kSmall, Progress::none()).value(), render({colored}));
  EXPECT_EQ(scene.render(kFrontView, kSmall, Progress::none()).value(), render({plain}));
  EXPECT_EQ(scene.recolored(0, {1.0, 2.0}, colored.scale).error().code,
            ErrorCode::kInvalidArgument);
}

TEST(RenderSurfaces, NeighboringTrianglesLeaveNoGap) {
  const TriangleMesh square = square_facing_front(30.0, 0.0);
  for (const double turn : {0.0, 0.1, 0.37, 0.785}) {
    View view = kFrontView;
    view.up_L = Vec3(std::sin(turn), 0.0, std::cos(turn));
    const Picture picture = render({{&square}}, view, {200, 200, 3});
    const int middle = brightness(picture, 100, 100);
    for (int row = 70; row < 130; ++row)
      for (int column = 70; column < 130; ++column)
        EXPECT_NEAR(brightness(picture, column, row), middle, 20) << column << " " << row;
  }
}

TEST(RenderSurfaces, CavityIsDarkerThanAnOpenPlane) {
  const TriangleMesh plane = square_facing_front(30.0, 0.0);
  TriangleMesh pit = plane;  // The same square at the bottom of four walls.
  pit.vertices.insert(
      pit.vertices.end(),
      {{-30.0, -60.0, -30.0}, {30.0, -60.0, -30.0}, {30.0, -60.0, 30.0}, {-30.0, -60.0, 30.0}});
  for (std::int32_t a = 0; a < 4; ++a) {
    const std::int32_t b = (a + 1) % 4;
    pit.triangles.push_back({a, b, b + 4});
    pit.triangles.push_back({a, b + 4, a + 4});
  }
  EXPECT_LT(brightness(render({{&pit}}), 100, 100), brightness(render({{&plane}}), 100, 100) - 60);
}

TEST(RenderSurfaces, BackSidesAreDarker) {
  const TriangleMesh front = square_facing_front(30.0, 0.0);
  TriangleMesh back = front;
  for (geometry::Triangle& triangle : back.triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_LT(brightness(render({{&back}}), 100, 100),
            brightness(render({{&front}}), 100, 100) - 100);
}

TEST(RenderSurfaces, ScalarsColorTheSurfaceAndNanIsGray) {
  const TriangleMesh square = square_facing_front(30.0, 0.0);
  const auto middle = [&](double value) {
    SurfaceLayer layer{.mesh_L = &square, .scalars = std::vector<double>(4, value)};
    layer.scale = {ColorMap::kDiverging, -1.0, 1.0};
    const Picture picture = render({layer});
    const std::uint8_t* rgba = picture.pixel(100, 100);
    return std::array<int, 3>{rgba[0], rgba[1], rgba[2]};
  };
  EXPECT_GT(middle(-1.0)[2], middle(-1.0)[0] + 60);  // Blue.
  EXPECT_GT(middle(1.0)[0], middle(1.0)[2] + 60);    // Red.
  EXPECT_NEAR(middle(kNan)[0], middle(kNan)[2], 12);
  EXPECT_LT(middle(kNan)[0], middle(0.0)[0] - 20);
}

TEST(RenderSurfaces, TransparentLayerShowsTheOneBehind) {
  const TriangleMesh glass = square_facing_front(40.0, -20.0);
  const TriangleMesh ball = sphere(Vec3::Zero(), 15.0, 30);
  const auto seen = [&](double opacity) {
    const SurfaceLayer pane{.mesh_L = &glass, .opacity = opacity};
    return difference(render({pane, {&ball, kBoneColor}}), render({pane})).count;
  };
  EXPECT_EQ(seen(1.0), 0);
  EXPECT_NEAR(double(seen(0.3)), std::numbers::pi * 900.0, 40.0);
  EXPECT_EQ(difference(render({{.mesh_L = &glass, .opacity = 0.0}}), render({})).count, 0);
}

TEST(RenderSurfaces, DrawsEmptyAndDegenerateMeshes) {
  const TriangleMesh empty;
  EXPECT_EQ(render({{&empty}}), render({}));
  TriangleMesh slivers = square_facing_front(30.0, 0.0);
  const Picture square = render({{&slivers}});
  slivers.triangles.push_back({0, 0, 0});
  slivers.triangles.push_back({0, 1, 1});
  slivers.vertices.push_back(Vec3::Zero());  // An unused vertex.
  EXPECT_EQ(difference(render({{&slivers}}), render({})).count,
            difference(square, render({})).count);
}

TEST(RenderSurfaces, RejectsMeshesWithMissingVertices) {
  TriangleMesh mesh = square_facing_front(30.0, 0.0);
  mesh.triangles.push_back({0, 1, 4});
  EXPECT_EQ(refusal({&mesh}), ErrorCode::kMeshInvalid);
  mesh.triangles.back() = {0, 1, -1};
  EXPECT_EQ(refusal({&mesh}), ErrorCode::kMeshInvalid);
  mesh.triangles.pop_back();
  for (const double coordinate : {kNan, std::numeric_limits<double>::infinity(), 1e7}) {
    mesh.vertices[2].y() = coordinate;
    EXPECT_EQ(refusal({&mesh}), ErrorCode::kMeshInvalid) << coordinate;
  }
}

TEST(RenderSurfaces, RejectsStylesOutOfRange) {
  const TriangleMesh mesh = square_facing_front(30.0, 0.0);
  EXPECT_EQ(refusal({.mesh_L = &mesh, .scalars = {1.0}}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(refusal({.mesh_L = &mesh, .opacity = 1.5}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(refusal({.mesh_L = &mesh, .opacity = kNan}), ErrorCode::kInvalidArgument);
  SurfaceLayer flat{.mesh_L = &mesh, .scalars = {1.0, 2.0, 3.0, 4.0}};
  flat.scale = {ColorMap::kSequential, 2.0, 2.0};
  EXPECT_EQ(refusal(flat), ErrorCode::kInvalidArgument);
}

TEST(RenderSurfaces, RejectsViewsAndSizesOutOfRange) {
  const auto scene = SurfaceScene::build({}, Progress::none());
  const auto refused = [&](const View& view, const PictureSize& size) {
    return scene->render(view, size, Progress::none()).error().code;
  };
  EXPECT_EQ(refused({.height_mm = -1.0}, kSmall), ErrorCode::kInvalidArgument);
  EXPECT_EQ(refused({}, {15, 100, 1}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(refused({}, {100, 8193, 1}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(refused({}, {100, 100, 5}), ErrorCode::kInvalidArgument);
}

TEST(RenderSurfaces, StopsOnRequest) {
  const TriangleMesh mesh = square_facing_front(30.0, 0.0);
  const SurfaceLayer layer{&mesh};
  StopAtOnce stop;
  EXPECT_EQ(SurfaceScene::build({&layer, 1}, stop).error().code, ErrorCode::kCancelled);
  const auto empty = SurfaceScene::build({}, stop);
  EXPECT_EQ(empty->render({}, kSmall, stop).error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::report::test_render_surfaces
