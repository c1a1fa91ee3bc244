/// \file
/// Pictures of surfaces by ray casting on the processor: needs no display and no graphics card.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/report/color_map.h>
#include <lefort/report/picture.h>
#include <lefort/report/view.h>

#include <memory>
#include <span>
#include <vector>

namespace lefort::report {

inline constexpr Rgb kSkinColor{0.87, 0.68, 0.58};
inline constexpr Rgb kBoneColor{0.93, 0.89, 0.79};

/// One surface of the picture. Need not be closed; its back sides are drawn darker.
struct SurfaceLayer {
  const geometry::TriangleMesh* mesh_L = nullptr;  ///< Not null; may be empty.
  Rgb color = kSkinColor;                          ///< Where there are no scalars.
  std::vector<double> scalars{};  ///< Empty, or one per vertex; NaN is drawn in kMissingColor.
  ColorScale scale{};             ///< How scalars become colors.
  double opacity = 1.0;           ///< 0 to 1. Of a layer below 1 only the nearest hit is seen.
};

struct PictureSize {
  int width = 1200;       ///< 16 to 8192 pixels.
  int height = 1000;      ///< 16 to 8192 pixels.
  int supersampling = 2;  ///< Rays along each side of a pixel, 1 to 4.
};

/// Surfaces made ready to be drawn from any side: search trees, smooth normals, and how much of the
/// surroundings each vertex sees. Preparing costs more than a picture, so do it once per state.
class SurfaceScene {
 public:
  /// \returns the scene, or
  ///   - kInvalidArgument  scalars that are not one per vertex, opacity outside [0, 1], an empty
  ///                       color scale, no memory
  ///   - kMeshInvalid      a triangle names a missing vertex, a vertex is NaN or over 1 km away
  ///   - kCancelled
  /// \note Nothing of `layers` need outlive the call. Same bits for any number of threads.
  [[nodiscard]] static Result<SurfaceScene> build(std::span<const SurfaceLayer> layers,
                                                  Progress& progress);

  /// \returns the picture without any writing (annotate.h), or kInvalidArgument for a view or size
  ///   out of range, kCancelled.
  [[nodiscard]] Result<Picture> render(const View& view, const PictureSize& size,
                                       Progress& progress) const;

  SurfaceScene(SurfaceScene&&) noexcept;
  SurfaceScene& operator=(SurfaceScene&&) noexcept;
  ~SurfaceScene();

 private:
  struct Prepared;
  explicit SurfaceScene(std::unique_ptr<const Prepared> prepared);
  std::unique_ptr<const Prepared> prepared_;
};

/// SurfaceScene::build, then render, for a single picture.
[[nodiscard]] Result<Picture> render_surfaces(std::span<const SurfaceLayer> layers,
                                              const View& view, const PictureSize& size,
                                              Progress& progress);

}  // namespace lefort::report
