/// \file
/// Renders surfaces on the CPU, without display or graphics card: visible triangles by
/// rasterization, light by ray casting.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/report/color_map.h>
#include <lefort/report/picture.h>
#include <lefort/report/view.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace lefort::report {

inline constexpr Rgb kSkinColor{0.87, 0.68, 0.58};
inline constexpr Rgb kBoneColor{0.93, 0.89, 0.79};

/// One surface of the picture, open or closed; back sides are drawn darker.
struct SurfaceLayer {
  const geometry::TriangleMesh* mesh_L = nullptr;  ///< Not null; may be empty.
  Rgb color = kSkinColor;                          ///< Used without scalars.
  std::vector<double> scalars{};  ///< Empty, or one per vertex; NaN is drawn in kMissingColor.
  ColorScale scale{};             ///< Colors of the scalars.
  double opacity = 1.0;  ///< 0 to 1. Below 1, only the closest hit of the layer is visible.
};

struct PictureSize {
  int width = 1200;       ///< 16 to 8192 pixels.
  int height = 1000;      ///< 16 to 8192 pixels.
  int supersampling = 2;  ///< Rays along each side of a pixel, 1 to 4.
};

/// Surfaces prepared for rendering from any view: search trees, smooth normals. Occlusion and
/// shadows are computed where a picture shows them, and kept for the next picture.
class SurfaceScene {
 public:
  /// \param layers    copied.
  /// \param progress  may request a stop.
  /// \returns the scene, or
  ///   - kInvalidArgument  the number of scalars is wrong, the opacity is outside [0, 1], a color
  ///                       scale is empty, or memory is exhausted
  ///   - kMeshInvalid      a triangle has a missing vertex, or a coordinate is NaN or beyond +-1 km
  ///   - kCancelled        `progress` requested a stop
  /// \note Same bits for any number of threads.
  [[nodiscard]] static Result<SurfaceScene> build(std::span<const SurfaceLayer> layers,
                                                  Progress& progress);

  /// The same surfaces in the colors of scalars; light that was computed is shared.
  ///
  /// \param layer    number of the layer, less than the number of layers.
  /// \param scalars  one per vertex; NaN is drawn in kMissingColor.
  /// \param scale    their colors.
  /// \returns the scene, or kInvalidArgument if the number of scalars is wrong or the scale empty.
  [[nodiscard]] Result<SurfaceScene> recolored(std::size_t layer, std::vector<double> scalars,
                                               const ColorScale& scale) const;

  /// \param view      the camera.
  /// \param size      of the picture.
  /// \param progress  receives the fraction done of the light on each layer, then of the rows; may
  ///   request a stop.
  /// \returns the picture without annotations (annotate.h), or kInvalidArgument for a view or size
  ///   out of range, or kCancelled.
  [[nodiscard]] Result<Picture> render(const View& view, const PictureSize& size,
                                       Progress& progress) const;

  SurfaceScene(SurfaceScene&&) noexcept;
  SurfaceScene& operator=(SurfaceScene&&) noexcept;
  ~SurfaceScene();

 private:
  struct Geometry;
  SurfaceScene(std::shared_ptr<Geometry> geometry, std::vector<SurfaceLayer> styles);
  std::shared_ptr<Geometry> geometry_;  ///< Locked while light is computed.
  std::vector<SurfaceLayer> styles_;    ///< Their mesh_L are not used.
};

/// Renders a single picture: SurfaceScene::build(), then SurfaceScene::render().
///
/// \param layers    the surfaces.
/// \param view      the camera.
/// \param size      of the picture.
/// \param progress  as for both functions.
/// \returns the picture, or the errors of both functions.
[[nodiscard]] Result<Picture> render_surfaces(std::span<const SurfaceLayer> layers,
                                              const View& view, const PictureSize& size,
                                              Progress& progress);

}  // namespace lefort::report
