/// \file
/// Three-point lighting of a point of a surface.
///
/// The lamps are fixed relative to the camera and symmetric to its left and right: as in clinical
/// photography, the light must not make a symmetric face look asymmetric.
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

/// \returns the direction to the key light in L: 38 degrees above the direction to the camera. Unit
///   length.
[[nodiscard]] Vec3 towards_key_light(const ViewAxes& camera);

struct SurfacePoint {
  Vec3 normal_L;      ///< Unit length, towards the camera.
  Light albedo;       ///< Reflected fraction of the light.
  double sky = 1.0;   ///< Ambient occlusion: visible fraction of the surroundings.
  double lamp = 1.0;  ///< Soft shadow: visible fraction of the key light.
  bool back = false;  ///< Seen from the inside of the surface.
};

/// \returns the light that `point` reflects to the camera.
[[nodiscard]] Light shade(const SurfacePoint& point, const ViewAxes& camera);

/// \param height_fraction  0 at the bottom of the picture, 1 at the top.
/// \returns the background: light and neutral, slightly darker at the bottom.
[[nodiscard]] Light backdrop(double height_fraction);

}  // namespace lefort::report
