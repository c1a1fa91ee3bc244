/// \file
/// From where a surface is looked at. Parallel projection: one scale holds in the whole picture,
/// and profiles can be laid over each other.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <string>

namespace lefort::report {

/// A camera far away. The same View for two states makes their pictures comparable by pixel.
struct View {
  Vec3 direction_L{0.0, 1.0, 0.0};  ///< Where the camera looks; not zero.
  Vec3 up_L{0.0, 0.0, 1.0};         ///< Upwards in the picture; not along direction_L.
  Vec3 center_L{0.0, 0.0, 0.0};     ///< In the middle of the picture [mm].
  double height_mm = 250.0;         ///< What the picture's height shows, > 0.
};

/// The views of clinical photography. Seen from the front, as when facing the patient, the
/// patient's right is on the left of the picture.
enum class StandardView {
  kFront,
  kRightProfile,       ///< The right side of the face; the nose points to the picture's right.
  kLeftProfile,        ///< The left side of the face; the nose points to the picture's left.
  kRightThreeQuarter,  ///< Half-way from the front to the right profile.
  kLeftThreeQuarter,   ///< Half-way from the front to the left profile.
};

/// "front", "right profile", ...
[[nodiscard]] const char* name_of(StandardView view);

/// Looks at the middle of `focus_L` from a standard side, so near that the box just fits.
///
/// \param focus_L  not empty; give before and after the same box.
/// \param aspect   width over height of the picture to be made, > 0.
[[nodiscard]] View standard_view(StandardView view, const Box3& focus_L, double aspect);

/// \returns kInvalidArgument when the view breaks what its members promise.
[[nodiscard]] Result<void> check_view(const View& view);

/// Rightwards, upwards in the picture, and towards the camera; unit length, right-handed, in L.
struct ViewAxes {
  Vec3 right_L;
  Vec3 up_L;
  Vec3 towards_L;
};
/// \pre check_view(view)
[[nodiscard]] ViewAxes axes_of(const View& view);

/// The side of the patient that `edge_L`, from the picture's middle to an edge, points to: "R",
/// "L", "A" (front), "P" (back), "S" (top), "I" (bottom); two letters, the stronger first, when the
/// view is oblique.
[[nodiscard]] std::string orientation_letters(const Vec3& edge_L);

}  // namespace lefort::report
