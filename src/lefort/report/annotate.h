/// \file
/// What must be written on a picture so that it can be read, and not be misread, on its own.
///
/// Text is drawn in DejaVu Sans (Debian: fonts-dejavu-core) or what fontconfig gives in its place;
/// a machine without any font gets cairo's built-in strokes.
#pragma once

#include <lefort/core/error.h>
#include <lefort/report/color_map.h>
#include <lefort/report/picture.h>
#include <lefort/report/view.h>

#include <optional>
#include <span>
#include <string>

namespace lefort::report {

/// Explains the colors of a picture.
struct ColorBar {
  ColorScale scale{};
  std::string title{};  ///< "displacement of the skin"
  std::string unit{};   ///< "mm"
};

struct Annotation {
  std::string caption{};                ///< At the top; may be empty.
  std::optional<ColorBar> color_bar{};  ///< For layers with scalars.
  std::optional<View> view{};           ///< As rendered: gives the patient's sides and a scale.
  bool converged = true;                ///< False puts red bands across the picture.
};

/// Said on page and pictures of a prediction that did not converge.
inline constexpr const char* kNotConvergedBanner = "NOT CONVERGED \u2013 not a result";

/// Writes onto the picture and adds a strip below it, with color bar, scale and
/// kNotForClinicalUse: only the caption, two letters in the lower corners, and the red bands can
/// cover anatomy.
/// The picture stays as wide and grows in height.
/// \returns kInvalidArgument for a malformed picture, an empty color scale or a bad view.
[[nodiscard]] Result<Picture> annotate(const Picture& picture, const Annotation& annotation);

/// Puts pictures in a row, top-aligned, each under its title.
/// \param titles one per picture, or none.
/// \returns kInvalidArgument when there is no picture, one is malformed, the titles do not match,
///   or the row gets larger than kMaxPictureSide.
[[nodiscard]] Result<Picture> side_by_side(std::span<const Picture> pictures,
                                           std::span<const std::string> titles);

}  // namespace lefort::report
