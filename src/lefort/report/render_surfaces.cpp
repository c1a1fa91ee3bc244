#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/report/internal/ray_scene.h>
#include <lefort/report/internal/three_point_lighting.h>
#include <lefort/report/internal/vertex_light.h>
#include <lefort/report/render_surfaces.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace lefort::report {

namespace {

constexpr double kMaxCoordinate = 1e6;    ///< [mm] Limit of sufficient single precision.
constexpr double kAmbientDistance = 0.2;  ///< Range of ambient occlusion over the scene's diagonal.

/// A layer with all data that do not depend on the view.
struct PreparedLayer {
  geometry::TriangleMesh mesh_L;
  SurfaceLayer style;  ///< Its mesh_L is not used.
  std::vector<Vec3> normals_L;
  std::vector<float> sky;
  RayScene surface;    ///< This layer only.
  RayScene obstacles;  ///< What casts shadows on it: the opaque layers and itself.
};

/// The intersection of a ray with one layer.
struct LayerHit {
  RayHit hit;
  std::size_t layer;
};

Result<void> check_layer(const SurfaceLayer& layer, std::size_t number) {
  LEFORT_CHECK(layer.mesh_L != nullptr);
  const geometry::TriangleMesh& mesh = *layer.mesh_L;
  const auto lost = std::find_if(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& p) {
    return !p.allFinite() || p.cwiseAbs().maxCoeff() > kMaxCoordinate;
  });
  if (lost != mesh.vertices.end())
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("vertex {} of surface {} is not within {} mm of the origin",
                            lost - mesh.vertices.begin(), number, kMaxCoordinate));
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    for (const std::int32_t corner : mesh.triangles[std::size_t(t)])
      if (corner < 0 || Index(corner) >= mesh.vertex_count())
        return fail(ErrorCode::kMeshInvalid,
                    fmt::format("triangle {} of surface {} has vertex {}, there are {}", t, number,
                                corner, mesh.vertex_count()));
  if (!layer.scalars.empty() && Index(layer.scalars.size()) != mesh.vertex_count())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("surface {} has {} scalars, must have one for each of {} vertices",
                            number, layer.scalars.size(), mesh.vertex_count()));
  if (!(layer.opacity >= 0.0 && layer.opacity <= 1.0))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("opacity of surface {} is {}, must be in [0, 1]", number, layer.opacity));
  if (!layer.scalars.empty()) return check_scale(layer.scale);
  return {};
}

/// Barycentric interpolation of vertex values at a hit.
template <class Value>
Value interpolate(const std::vector<Value>& values, const geometry::Triangle& corners,
                  const RayHit& hit) {
  using Weight = std::conditional_t<std::is_same_v<Value, float>, float, double>;
  return Weight(1.0 - hit.u - hit.v) * values[std::size_t(corners[0])] +
         Weight(hit.u) * values[std::size_t(corners[1])] +
         Weight(hit.v) * values[std::size_t(corners[2])];
}

/// Shades `layer` at `hit`; `lamp` is the visible fraction of the key light per vertex.
Light light_at(const PreparedLayer& layer, const std::vector<float>& lamp, const RayHit& hit,
               const ViewAxes& camera) {
  const geometry::Triangle& corners = layer.mesh_L.triangles[hit.triangle];
  SurfacePoint point;
  point.back = hit.normal_L.dot(camera.towards_L) < 0.0;
  Vec3 normal_L = interpolate(layer.normals_L, corners, hit);
  if (normal_L.squaredNorm() < 1e-6) normal_L = hit.normal_L;
  point.normal_L = normal_L.normalized() * (point.back ? -1.0 : 1.0);
  point.sky = double(interpolate(layer.sky, corners, hit));
  point.lamp = double(interpolate(lamp, corners, hit));
  const SurfaceLayer& style = layer.style;
  point.albedo =
      light_of(style.scalars.empty() ? style.color
                                     : style.scale.color(interpolate(style.scalars, corners, hit)));
  return shade(point, camera);
}

}  // namespace

struct SurfaceScene::Prepared {
  std::vector<PreparedLayer> layers;
  Box3 box_L;
};

SurfaceScene::SurfaceScene(std::unique_ptr<const Prepared> prepared)
    : prepared_(std::move(prepared)) {}
SurfaceScene::SurfaceScene(SurfaceScene&&) noexcept = default;
SurfaceScene& SurfaceScene::operator=(SurfaceScene&&) noexcept = default;
SurfaceScene::~SurfaceScene() = default;

Result<SurfaceScene> SurfaceScene::build(std::span<const SurfaceLayer> layers, Progress& progress) {
  auto prepared = std::make_unique<Prepared>();
  for (std::size_t n = 0; n < layers.size(); ++n) {
    LEFORT_TRY_VOID(check_layer(layers[n], n));
    for (const Vec3& vertex_L : layers[n].mesh_L->vertices) prepared->box_L.extend(vertex_L);
  }
  const double max_distance_mm =
      prepared->box_L.isEmpty() ? 0.0 : kAmbientDistance * prepared->box_L.diagonal().norm();
  for (std::size_t n = 0; n < layers.size(); ++n) {
    const geometry::TriangleMesh& mesh_L = *layers[n].mesh_L;
    std::vector<const geometry::TriangleMesh*> obstacle_meshes;
    for (std::size_t other = 0; other < layers.size(); ++other)
      if (other == n || layers[other].opacity == 1.0)
        obstacle_meshes.push_back(layers[other].mesh_L);
    const geometry::TriangleMesh* const alone = &mesh_L;
    LEFORT_TRY(RayScene surface, RayScene::build({&alone, 1}));
    LEFORT_TRY(RayScene obstacles, obstacle_meshes.size() == 1 ? Result<RayScene>(surface)
                                                               : RayScene::build(obstacle_meshes));
    std::vector<Vec3> normals_L = vertex_normals(mesh_L);
    LEFORT_TRY(std::vector<float> sky,
               ambient_occlusion(mesh_L, normals_L, obstacles, max_distance_mm, progress));
    prepared->layers.push_back({mesh_L, layers[n], std::move(normals_L), std::move(sky),
                                std::move(surface), std::move(obstacles)});
  }
  return SurfaceScene(std::move(prepared));
}

namespace {

/// Renders one picture: the camera, and the lighting of the layers.
class Exposure {
 public:
  Exposure(const std::vector<PreparedLayer>& layers, const Box3& box_L, const View& view,
           const PictureSize& size)
      : layers_(layers), camera_(axes_of(view)), size_(size) {
    mm_per_pixel_ = view.height_mm / double(size.height);
    // Rays start in a plane in front of all layers.
    const double nearest_mm =
        box_L.isEmpty()
            ? 0.0
            : camera_.towards_L.dot(box_L.center() - view.center_L) + 0.5 * box_L.diagonal().norm();
    start_middle_ = view.center_L + (nearest_mm + 1.0) * camera_.towards_L;
  }

  Result<void> light(Progress& progress) {
    for (const PreparedLayer& layer : layers_) {
      LEFORT_TRY(auto lamp, soft_shadow(layer.mesh_L, layer.normals_L, layer.obstacles,
                                        towards_key_light(camera_), progress));
      lamps_.push_back(std::move(lamp));
    }
    return {};
  }

  /// The mean over the rays of a pixel.
  [[nodiscard]] Light pixel(int column, int row) const {
    Light sum = Light::Zero();
    const int n = size_.supersampling;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        sum += ray(double(column) + (double(i) + 0.5) / n, double(row) + (double(j) + 0.5) / n);
    return sum / double(n * n);
  }

 private:
  [[nodiscard]] Light ray(double x, double y) const {
    const Vec3 origin_L =
        start_middle_ + mm_per_pixel_ * ((x - 0.5 * size_.width) * camera_.right_L +
                                         (0.5 * size_.height - y) * camera_.up_L);
    std::vector<LayerHit>& hits = scratch();
    for (std::size_t n = 0; n < layers_.size(); ++n)
      if (const auto hit = layers_[n].surface.closest(origin_L, -camera_.towards_L))
        hits.push_back({*hit, n});
    std::stable_sort(hits.begin(), hits.end(), [](const LayerHit& a, const LayerHit& b) {
      return a.hit.distance_mm < b.hit.distance_mm;
    });
    Light seen = Light::Zero();
    double clear = 1.0;  // Fraction of the light behind that is transmitted.
    for (const LayerHit& each : hits) {
      const PreparedLayer& layer = layers_[each.layer];
      const double opacity = opacity_at(layer, each.hit);
      seen += clear * opacity * light_at(layer, lamps_[each.layer], each.hit, camera_);
      clear *= 1.0 - opacity;
      if (clear == 0.0) break;
    }
    return seen + clear * backdrop(1.0 - y / double(size_.height));
  }

  /// Transparent layers are more opaque at grazing angles, so that their silhouette is visible.
  [[nodiscard]] double opacity_at(const PreparedLayer& layer, const RayHit& hit) const {
    const double opacity = layer.style.opacity;
    if (opacity == 0.0) return 0.0;
    const double grazing = 1.0 - std::abs(hit.normal_L.dot(camera_.towards_L));
    return opacity + (1.0 - opacity) * 0.6 * grazing * grazing * grazing;
  }

  static std::vector<LayerHit>& scratch() {  // Avoids an allocation per ray.
    thread_local std::vector<LayerHit> hits;
    hits.clear();
    return hits;
  }

  const std::vector<PreparedLayer>& layers_;
  ViewAxes camera_;
  PictureSize size_;
  double mm_per_pixel_;
  Vec3 start_middle_;
  std::vector<std::vector<float>> lamps_;
};

Result<void> check_size(const PictureSize& size) {
  const auto fits = [](int side) { return side >= 16 && side <= 8192; };
  if (!fits(size.width) || !fits(size.height))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("picture would have {} x {} pixels, each side must be in [16, 8192]",
                            size.width, size.height));
  if (size.supersampling < 1 || size.supersampling > 4)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("supersampling is {}, must be in [1, 4]", size.supersampling));
  return {};
}

}  // namespace

Result<Picture> SurfaceScene::render(const View& view, const PictureSize& size,
                                     Progress& progress) const {
  LEFORT_TRY_VOID(check_view(view));
  LEFORT_TRY_VOID(check_size(size));
  Exposure exposure(prepared_->layers, prepared_->box_L, view, size);
  LEFORT_TRY_VOID(exposure.light(progress));
  Picture picture{
      size.width, size.height,
      std::vector<std::uint8_t>(4 * std::size_t(size.width) * std::size_t(size.height))};
  constexpr int kRows = 64;  // Between two checks for a stop request.
  for (int top = 0; top < size.height; top += kRows) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "rendering was cancelled");
    progress.report(double(top) / double(size.height));
    const int rows = std::min(kRows, size.height - top);
    parallel_for(Index(rows) * size.width, [&](Index n) {
      const Index index = Index(top) * size.width + n;
      const Light light = exposure.pixel(int(index % size.width), int(index / size.width));
      std::uint8_t* const rgba = picture.rgba.data() + 4 * index;
      for (int c = 0; c < 3; ++c) rgba[c] = std::uint8_t(std::lround(255.0 * srgb_of(light[c])));
      rgba[3] = 255;
    });
  }
  return picture;
}

Result<Picture> render_surfaces(std::span<const SurfaceLayer> layers, const View& view,
                                const PictureSize& size, Progress& progress) {
  LEFORT_TRY(const SurfaceScene scene, SurfaceScene::build(layers, progress));
  return scene.render(view, size, progress);
}

}  // namespace lefort::report
