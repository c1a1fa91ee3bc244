/// \file
/// Camera positions. Parallel projection: the scale is the same in the whole picture, and profiles
/// can be superimposed.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <string>

namespace lefort::report {

/// A camera at infinity. Pictures of two states with the same View can be compared by pixel.
struct View {
  Vec3 direction_L{0.0, 1.0, 0.0};  ///< Viewing direction; not zero.
  Vec3 up_L{0.0, 0.0, 1.0};         ///< Upwards in the picture; not parallel to direction_L.
  Vec3 center_L{0.0, 0.0, 0.0};     ///< At the center of the picture [mm].
  double height_mm = 250.0;         ///< Visible height, > 0.
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

/// \param view  a standard view.
/// \returns "front", "right profile", ...
[[nodiscard]] const char* name_of(StandardView view);

/// Views the center of `focus_L` from a standard direction, with the height at which the box fits.
///
/// \param view     the standard direction.
/// \param focus_L  not empty; use the same box before and after.
/// \param aspect   width over height of the picture, > 0.
/// \returns the camera.
[[nodiscard]] View standard_view(StandardView view, const Box3& focus_L, double aspect);

/// \param view  any values.
/// \returns nothing, or kInvalidArgument if a member of the view is out of range.
[[nodiscard]] Result<void> check_view(const View& view);

/// Rightwards, upwards in the picture, and towards the camera; unit length, right-handed, in L.
struct ViewAxes {
  Vec3 right_L;
  Vec3 up_L;
  Vec3 towards_L;
};
/// \param view  valid according to check_view().
/// \returns its axes.
[[nodiscard]] ViewAxes axes_of(const View& view);

/// \param edge_L  direction from the center of the picture to an edge.
/// \returns the side of the patient at that edge: "R", "L", "A" (anterior), "P" (posterior), "S"
///   (superior) or "I" (inferior); two letters, the larger component first, for an oblique view.
[[nodiscard]] std::string orientation_letters(const Vec3& edge_L);

}  // namespace lefort::report
