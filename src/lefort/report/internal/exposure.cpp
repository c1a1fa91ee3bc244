#include <lefort/core/check.h>
#include <lefort/report/internal/exposure.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

namespace lefort::report {

namespace {

/// Barycentric interpolation of vertex values at a hit.
template <class Value>
Value interpolate(const std::vector<Value>& values, const geometry::Triangle& corners,
                  const RasterHit& hit) {
  using Weight = std::conditional_t<std::is_same_v<Value, float>, float, double>;
  return Weight(1.0F - hit.u - hit.v) * values[std::size_t(corners[0])] +
         Weight(hit.u) * values[std::size_t(corners[1])] +
         Weight(hit.v) * values[std::size_t(corners[2])];
}

}  // namespace

Exposure::Exposure(std::vector<ViewLayer> layers, const View& view, const PictureSize& size)
    : layers_(std::move(layers)), size_(size) {
  const int n = size.supersampling;
  grid_ = {axes_of(view), view.center_L, view.height_mm / double(size.height) / n, n * size.width,
           n * size.height};
  rasters_.reserve(layers_.size());
  for (ViewLayer& layer : layers_) {
    layer.albedo = light_of(layer.style.color);
    is_opaque_ = is_opaque_ && layer.style.opacity == 1.0;
    rasters_.emplace_back(layer.mesh_L, grid_, n * kBandRows);
  }
}

Exposure::BandHits Exposure::rasterize(int band) const {
  BandHits hits(layers_.size());
  for (std::size_t n = 0; n < layers_.size(); ++n) rasters_[n].rasterize(band, hits[n]);
  return hits;
}

/// The visible layers at a sample, the closest first.
void Exposure::collect(const BandHits& band, std::size_t sample,
                       std::vector<LayerHit>& hits) const {
  const std::size_t begin = hits.size();
  for (std::size_t n = 0; n < band.size(); ++n)
    if (band[n][sample].is_hit()) hits.push_back({band[n][sample], n});
  const auto from = hits.begin() + std::ptrdiff_t(begin);
  if (hits.end() - from < 2) return;
  std::stable_sort(from, hits.end(), [](const LayerHit& a, const LayerHit& b) {
    return a.hit.depth_mm < b.hit.depth_mm;
  });
  const auto opaque = std::find_if(
      from, hits.end(), [&](const LayerHit& at) { return layers_[at.layer].style.opacity == 1.0; });
  if (opaque != hits.end()) hits.erase(opaque + 1, hits.end());
}

std::vector<LayerTriangle> Exposure::visible_in(int band) const {
  const BandHits band_hits = rasterize(band);
  std::vector<LayerTriangle> visible;
  std::vector<LayerHit> hits;
  const std::size_t samples = band_hits.empty() ? 0 : band_hits.front().size();
  for (std::size_t s = 0; s < samples; ++s) {
    hits.clear();
    collect(band_hits, s, hits);
    for (const LayerHit& at : hits) {
      const LayerTriangle seen{at.layer, at.hit.triangle};
      if (visible.empty() || visible.back() != seen) visible.push_back(seen);
    }
  }
  return visible;
}

void Exposure::set_light(std::size_t layer, std::vector<float> sky, std::vector<float> lamp) {
  layers_[layer].sky = std::move(sky);
  layers_[layer].lamp = std::move(lamp);
}

/// Of the triangle, outward; length of twice its area.
Vec3 Exposure::flat_normal(const LayerHit& at) const {
  const geometry::TriangleMesh& mesh_L = layers_[at.layer].mesh_L;
  const Index t = at.hit.triangle;
  return (mesh_L.corner(t, 1) - mesh_L.corner(t, 0))
      .cross(mesh_L.corner(t, 2) - mesh_L.corner(t, 0));
}

/// Adds normal (towards the camera), light and scalar at a hit.
void Exposure::add(const LayerHit& at, SurfacePoint& point, double& scalar) const {
  const ViewLayer& layer = layers_[at.layer];
  const geometry::Triangle& corners = layer.mesh_L.triangles[at.hit.triangle];
  const Vec3 flat_L = flat_normal(at);
  point.back = flat_L.dot(grid_.camera.towards_L) < 0.0;
  Vec3 normal_L = interpolate(layer.normals_L, corners, at.hit);
  if (normal_L.squaredNorm() < 1e-6) normal_L = flat_L;
  point.normal_L += normal_L.normalized() * (point.back ? -1.0 : 1.0);
  point.sky += double(interpolate(layer.sky, corners, at.hit));
  point.lamp += double(interpolate(layer.lamp, corners, at.hit));
  if (!layer.style.scalars.empty()) scalar += interpolate(layer.style.scalars, corners, at.hit);
}

Light Exposure::reflected(std::size_t layer, SurfacePoint point, double scalar) const {
  const ViewLayer& seen = layers_[layer];
  point.albedo =
      seen.style.scalars.empty() ? seen.albedo : light_of(seen.style.scale.color(scalar));
  return shade(point, grid_.camera);
}

Light Exposure::sample(std::span<const LayerHit> hits, double height_fraction) const {
  Light seen = Light::Zero();
  double clear = 1.0;  // Fraction of the light behind that is transmitted.
  for (const LayerHit& at : hits) {
    double opacity = layers_[at.layer].style.opacity;
    if (opacity == 0.0) continue;
    // Transparent layers are more opaque at grazing angles, so that their silhouette is visible.
    const double grazing = 1.0 - std::abs(flat_normal(at).normalized().dot(grid_.camera.towards_L));
    opacity += (1.0 - opacity) * 0.6 * grazing * grazing * grazing;
    SurfacePoint point{.normal_L = Vec3::Zero(), .albedo = Light::Zero(), .sky = 0.0, .lamp = 0.0};
    double scalar = 0.0;
    add(at, point, scalar);
    seen += clear * opacity * reflected(at.layer, point, scalar);
    clear *= 1.0 - opacity;
    if (clear == 0.0) break;
  }
  return seen + clear * backdrop(height_fraction);
}

/// Whether all samples of a pixel show the same opaque layer, without a step in depth.
bool Exposure::is_one_surface(std::span<const LayerHit> hits, std::size_t samples) const {
  constexpr double kMaxSlope = 3.0;  // Depth over width.
  if (!is_opaque_ || hits.size() != samples) return false;
  float nearest = hits.front().hit.depth_mm, farthest = nearest;
  for (const LayerHit& at : hits) {
    if (at.layer != hits.front().layer) return false;
    nearest = std::min(nearest, at.hit.depth_mm);
    farthest = std::max(farthest, at.hit.depth_mm);
  }
  return double(farthest - nearest) < kMaxSlope * size_.supersampling * grid_.mm_per_sample;
}

/// The mean over the samples of a pixel; nothing if opaque layers leave it empty. A pixel of one
/// surface is shaded once, at the mean point.
std::optional<Light> Exposure::pixel(const BandHits& band, int column, int row_in_band, int row,
                                     std::vector<LayerHit>& hits) const {
  const int n = size_.supersampling;
  const auto height_fraction = [&](int j) {
    return 1.0 - (double(row) + (double(j) + 0.5) / n) / double(size_.height);
  };
  const auto number = [&](int i, int j) {
    return std::size_t(row_in_band * n + j) * std::size_t(grid_.columns) +
           std::size_t(column * n + i);
  };
  hits.clear();
  for (int j = 0; is_opaque_ && j < n; ++j)
    for (int i = 0; i < n; ++i) collect(band, number(i, j), hits);
  if (is_opaque_ && hits.empty()) return std::nullopt;
  const auto samples = std::size_t(n * n);
  if (is_one_surface(hits, samples)) {
    SurfacePoint mean{.normal_L = Vec3::Zero(), .albedo = Light::Zero(), .sky = 0.0, .lamp = 0.0};
    double scalar = 0.0;
    bool is_back = false, is_front = false;
    for (const LayerHit& at : hits) {
      add(at, mean, scalar);
      (mean.back ? is_back : is_front) = true;
    }
    if (is_back != is_front && !std::isnan(scalar) && !mean.normal_L.isZero()) {
      mean.normal_L.normalize();
      mean.sky /= double(samples);
      mean.lamp /= double(samples);
      return reflected(hits.front().layer, mean, scalar / double(samples));
    }
  }
  Light sum = Light::Zero();
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      hits.clear();
      collect(band, number(i, j), hits);
      sum += sample(hits, height_fraction(j));
    }
  return sum / double(samples);
}

void Exposure::draw(int band, Picture& picture) const {
  const BandHits band_hits = rasterize(band);
  std::vector<LayerHit> hits;
  const int top = band * kBandRows, bottom = std::min(size_.height, top + kBandRows);
  const auto bytes_of = [](const Light& light) {
    std::array<std::uint8_t, 4> rgba{0, 0, 0, 255};
    for (std::size_t c = 0; c < 3; ++c)
      rgba[c] = std::uint8_t(std::lround(255.0 * srgb_of(light[Index(c)])));
    return rgba;
  };
  for (int row = top; row < bottom; ++row) {
    std::uint8_t* rgba = picture.rgba.data() + 4 * std::size_t(row) * std::size_t(size_.width);
    const auto empty = bytes_of(backdrop(1.0 - (double(row) + 0.5) / size_.height));
    for (int column = 0; column < size_.width; ++column, rgba += 4) {
      const std::optional<Light> light = pixel(band_hits, column, row - top, row, hits);
      const auto color = light ? bytes_of(*light) : empty;
      std::copy(color.begin(), color.end(), rgba);
    }
  }
}

}  // namespace lefort::report
