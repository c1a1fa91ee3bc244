/// \file
/// How a point of a surface looks under the lamps of a portrait studio.
///
/// The lamps stand still relative to the camera and are alike on its left and right: as in clinical
/// photography, light must not make a straight face look crooked.
#pragma once

#include <lefort/core/types.h>
#include <lefort/report/color_map.h>
#include <lefort/report/view.h>

namespace lefort::report {

/// Amounts of red, green, blue light; 1 is white on the screen.
using Light = Eigen::Array3d;

/// sRGB (IEC 61966-2-1) to amounts of light, and back to [0, 1].
[[nodiscard]] Light light_of(const Rgb& color);
[[nodiscard]] double srgb_of(double light);

/// The direction of the main lamp in L: in front of the face, above the camera. Unit length.
[[nodiscard]] Vec3 towards_key_light(const ViewAxes& camera);

struct SurfacePoint {
  Vec3 normal_L;      ///< Unit length, to the side that is seen.
  Light albedo;       ///< Share of light it throws back.
  double sky = 1.0;   ///< Share of the surroundings it sees.
  double lamp = 1.0;  ///< Share of the main lamp it sees.
  bool back = false;  ///< Seen from the inside of the surface.
};

/// The light that `point` sends to the camera.
[[nodiscard]] Light shade(const SurfacePoint& point, const ViewAxes& camera);

/// What is behind everything: light and neutral, a little darker at the bottom.
/// \param height_fraction 0 at the bottom of the picture, 1 at the top.
[[nodiscard]] Light backdrop(double height_fraction);

}  // namespace lefort::report
