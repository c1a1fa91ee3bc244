/// \file
/// Rasterization of a surface in parallel projection: the closest triangle at each sample.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/report/view.h>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace lefort::report {

/// The samples of a picture: a camera and a grid of points. Row 0 is the topmost.
struct SampleGrid {
  ViewAxes camera;
  Vec3 center_L;         ///< At the middle of the grid [mm].
  double mm_per_sample;  ///< > 0.
  int columns, rows;     ///< >= 1.
};

/// The closest point of a surface at one sample.
struct RasterHit {
  static constexpr std::uint32_t kNothing = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t triangle = kNothing;  ///< kNothing if the surface does not cover the sample.
  float u = 0.0F, v = 0.0F;           ///< Barycentric weights of the second and third corner.
  /// Behind the plane through center_L [mm]; negative towards the camera.
  float depth_mm = std::numeric_limits<float>::infinity();

  [[nodiscard]] bool is_hit() const { return triangle != kNothing; }
};

/// A surface projected onto a grid of samples, with its triangles sorted into bands of rows.
/// Neighboring triangles leave no gap; of triangles at the same depth the first is taken.
class SurfaceRaster {
 public:
  /// \param mesh_L     coordinates are finite; kept by reference.
  /// \param grid       the samples.
  /// \param band_rows  rows of a band, >= 1.
  SurfaceRaster(const geometry::TriangleMesh& mesh_L, const SampleGrid& grid, int band_rows);

  /// \param band  0 to ceil(rows / band_rows) - 1.
  /// \param hits  receives columns * band_rows hits, row by row; rows below the grid hit nothing.
  void rasterize(int band, std::vector<RasterHit>& hits) const;

 private:
  void draw(std::uint32_t triangle, int first_row, int last_row,
            std::vector<RasterHit>& hits) const;

  const geometry::TriangleMesh& mesh_L_;
  int columns_, rows_, band_rows_;
  std::vector<Vec3> projected_;        ///< Column, row, and depth [mm] of each vertex.
  std::vector<std::uint32_t> sorted_;  ///< Triangles, band by band.
  std::vector<std::size_t> first_;     ///< Of each band in sorted_; then their number.
};

}  // namespace lefort::report
