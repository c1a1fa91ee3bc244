#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/report/internal/exposure.h>
#include <lefort/report/internal/ray_scene.h>
#include <lefort/report/internal/three_point_lighting.h>
#include <lefort/report/internal/vertex_light.h>
#include <lefort/report/render_surfaces.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

namespace lefort::report {

namespace {

constexpr double kMaxCoordinate = 1e6;    ///< [mm] Limit of sufficient single precision.
constexpr double kAmbientDistance = 0.2;  ///< Range of ambient occlusion over the scene's diagonal.

constexpr int kBands = 8;  ///< Bands per check for a stop request and thread.

/// A layer with the data that do not depend on colors, and the light of all pictures so far.
struct PreparedLayer {
  geometry::TriangleMesh mesh_L;
  std::vector<Vec3> normals_L;
  RayScene obstacles;  ///< What casts shadows on it: the opaque layers and itself.
  VertexFractions sky;
  std::vector<std::pair<Vec3, VertexFractions>> lamps;  ///< For each direction of the key light.

  [[nodiscard]] VertexFractions& lamp(const Vec3& direction_L) {
    for (auto& [known_L, fractions] : lamps)
      if (known_L == direction_L) return fractions;
    return lamps.emplace_back(direction_L, VertexFractions(mesh_L.vertices.size())).second;
  }
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

}  // namespace

struct SurfaceScene::Geometry {
  std::vector<PreparedLayer> layers;
  double ambient_distance_mm = 0.0;
  std::mutex light;
};

SurfaceScene::SurfaceScene(std::shared_ptr<Geometry> geometry, std::vector<SurfaceLayer> styles)
    : geometry_(std::move(geometry)), styles_(std::move(styles)) {}
SurfaceScene::SurfaceScene(SurfaceScene&&) noexcept = default;
SurfaceScene& SurfaceScene::operator=(SurfaceScene&&) noexcept = default;
SurfaceScene::~SurfaceScene() = default;

Result<SurfaceScene> SurfaceScene::build(std::span<const SurfaceLayer> layers, Progress& progress) {
  auto geometry = std::make_shared<Geometry>();
  Box3 box_L;
  std::vector<const geometry::TriangleMesh*> opaque;
  for (std::size_t n = 0; n < layers.size(); ++n) {
    LEFORT_TRY_VOID(check_layer(layers[n], n));
    for (const Vec3& vertex_L : layers[n].mesh_L->vertices) box_L.extend(vertex_L);
    if (layers[n].opacity == 1.0) opaque.push_back(layers[n].mesh_L);
  }
  if (!box_L.isEmpty()) geometry->ambient_distance_mm = kAmbientDistance * box_L.diagonal().norm();
  std::optional<RayScene> opaque_obstacles;
  for (const SurfaceLayer& layer : layers) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "rendering was cancelled");
    std::vector<const geometry::TriangleMesh*> meshes = opaque;
    if (layer.opacity != 1.0) meshes.push_back(layer.mesh_L);
    std::optional<RayScene> obstacles = layer.opacity == 1.0 ? opaque_obstacles : std::nullopt;
    if (!obstacles) {
      LEFORT_TRY(obstacles, RayScene::build(meshes));
    }
    if (layer.opacity == 1.0) opaque_obstacles = obstacles;
    geometry->layers.push_back({*layer.mesh_L,
                                vertex_normals(*layer.mesh_L),
                                *std::move(obstacles),
                                VertexFractions(layer.mesh_L->vertices.size()),
                                {}});
  }
  return SurfaceScene(std::move(geometry), {layers.begin(), layers.end()});
}

Result<SurfaceScene> SurfaceScene::recolored(std::size_t layer, std::vector<double> scalars,
                                             const ColorScale& scale) const {
  LEFORT_CHECK(layer < styles_.size());
  std::vector<SurfaceLayer> styles = styles_;
  styles[layer].mesh_L = &geometry_->layers[layer].mesh_L;
  styles[layer].scalars = std::move(scalars);
  styles[layer].scale = scale;
  LEFORT_TRY_VOID(check_layer(styles[layer], layer));
  return SurfaceScene(geometry_, std::move(styles));
}

namespace {

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

/// Computes the light of the triangles that a picture shows.
Result<void> light_layers(Exposure& exposure,
                          std::span<const std::vector<LayerTriangle>> visible_in_bands,
                          std::span<PreparedLayer> layers, double ambient_distance_mm,
                          Progress& progress) {
  std::vector<std::vector<char>> visible;
  for (const PreparedLayer& layer : layers) visible.emplace_back(layer.mesh_L.triangles.size(), 0);
  for (const std::vector<LayerTriangle>& band : visible_in_bands)
    for (const auto& [layer, triangle] : band) visible[layer][triangle] = 1;
  const Vec3 lamp_L = towards_key_light(exposure.camera());
  for (std::size_t n = 0; n < layers.size(); ++n) {
    PreparedLayer& layer = layers[n];
    const ShadedSurface surface{layer.mesh_L, layer.normals_L, layer.obstacles};
    const LitRegion region = lit_region(layer.mesh_L, visible[n]);
    LEFORT_TRY(std::vector<float> sky,
               ambient_occlusion(surface, region, ambient_distance_mm, layer.sky, progress));
    LEFORT_TRY(std::vector<float> lamp,
               soft_shadow(surface, region, lamp_L, layer.lamp(lamp_L), progress));
    exposure.set_light(n, std::move(sky), std::move(lamp));
  }
  return {};
}

}  // namespace

Result<Picture> SurfaceScene::render(const View& view, const PictureSize& size,
                                     Progress& progress) const {
  LEFORT_TRY_VOID(check_view(view));
  LEFORT_TRY_VOID(check_size(size));
  std::vector<ViewLayer> layers;
  for (std::size_t n = 0; n < styles_.size(); ++n)
    layers.push_back({geometry_->layers[n].mesh_L, geometry_->layers[n].normals_L, styles_[n]});
  Exposure exposure(std::move(layers), view, size);
  const auto cancelled = [] { return fail(ErrorCode::kCancelled, "rendering was cancelled"); };
  const int bands = exposure.band_count();
  const int group = kBands * std::max(1, ThreadLimit::current());
  std::vector<std::vector<LayerTriangle>> visible;
  visible.resize(std::size_t(bands));
  for (int first = 0; first < bands; first += group) {
    if (progress.stop_requested()) return cancelled();
    parallel_for(
        std::min(group, bands - first),
        [&](Index n) { visible[std::size_t(first + n)] = exposure.visible_in(first + int(n)); }, 1);
  }
  {
    const std::lock_guard<std::mutex> lock(geometry_->light);
    LEFORT_TRY_VOID(light_layers(exposure, visible, geometry_->layers,
                                 geometry_->ambient_distance_mm, progress));
  }
  Picture picture{
      size.width, size.height,
      std::vector<std::uint8_t>(4 * std::size_t(size.width) * std::size_t(size.height))};
  for (int first = 0; first < bands; first += group) {
    if (progress.stop_requested()) return cancelled();
    progress.report(double(first) / double(bands));
    parallel_for(
        std::min(group, bands - first), [&](Index n) { exposure.draw(first + int(n), picture); },
        1);
  }
  return picture;
}

Result<Picture> render_surfaces(std::span<const SurfaceLayer> layers, const View& view,
                                const PictureSize& size, Progress& progress) {
  LEFORT_TRY(const SurfaceScene scene, SurfaceScene::build(layers, progress));
  return scene.render(view, size, progress);
}

}  // namespace lefort::report
