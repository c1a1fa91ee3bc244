/// \file
/// One picture of surfaces: what is visible, and its colors.
#pragma once

#include <lefort/geometry/triangle_mesh.h>
#include <lefort/report/internal/surface_raster.h>
#include <lefort/report/internal/three_point_lighting.h>
#include <lefort/report/picture.h>
#include <lefort/report/render_surfaces.h>
#include <lefort/report/view.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lefort::report {

/// A layer as one picture shows it. The light is valid at the corners of visible triangles.
struct ViewLayer {
  const geometry::TriangleMesh& mesh_L;
  const std::vector<Vec3>& normals_L;
  const SurfaceLayer& style;  ///< Its mesh_L is not used.
  Light albedo{0.0, 0.0, 0.0};
  std::vector<float> sky{}, lamp{};
};

struct LayerTriangle {
  std::size_t layer;
  std::uint32_t triangle;
  bool operator==(const LayerTriangle&) const = default;
};

/// Renders one picture in bands of rows. First visible_in() of all bands, then set_light() of all
/// layers, then draw().
class Exposure {
 public:
  static constexpr int kBandRows = 16;  ///< Rows of pixels of a band.

  /// \param layers  references remain valid.
  /// \param view    valid according to check_view().
  /// \param size    of the picture.
  Exposure(std::vector<ViewLayer> layers, const View& view, const PictureSize& size);

  [[nodiscard]] int band_count() const { return (size_.height + kBandRows - 1) / kBandRows; }
  [[nodiscard]] const ViewAxes& camera() const { return grid_.camera; }

  /// \param band  0 to band_count() - 1.
  /// \returns the triangles that the band shows; some of them several times.
  [[nodiscard]] std::vector<LayerTriangle> visible_in(int band) const;

  /// \param layer  its number.
  /// \param sky    ambient occlusion at its vertices.
  /// \param lamp   visible fraction of the key light at its vertices.
  void set_light(std::size_t layer, std::vector<float> sky, std::vector<float> lamp);

  /// \param band     0 to band_count() - 1.
  /// \param picture  receives the rows of the band.
  void draw(int band, Picture& picture) const;

 private:
  /// A layer at a sample.
  struct LayerHit {
    RasterHit hit;
    std::size_t layer;
  };
  using BandHits = std::vector<std::vector<RasterHit>>;  ///< For each layer, those of its raster.

  [[nodiscard]] BandHits rasterize(int band) const;
  void collect(const BandHits& band, std::size_t sample, std::vector<LayerHit>& hits) const;
  [[nodiscard]] Vec3 flat_normal(const LayerHit& at) const;
  void add(const LayerHit& at, SurfacePoint& point, double& scalar) const;
  [[nodiscard]] Light reflected(std::size_t layer, SurfacePoint point, double scalar) const;
  [[nodiscard]] Light sample(std::span<const LayerHit> hits, double height_fraction) const;
  [[nodiscard]] bool is_one_surface(std::span<const LayerHit> hits, std::size_t samples) const;
  [[nodiscard]] std::optional<Light> pixel(const BandHits& band, int column, int row_in_band,
                                           int row, std::vector<LayerHit>& hits) const;

  std::vector<ViewLayer> layers_;
  PictureSize size_;
  SampleGrid grid_;
  std::vector<SurfaceRaster> rasters_;
  bool is_opaque_ = true;
};

}  // namespace lefort::report
