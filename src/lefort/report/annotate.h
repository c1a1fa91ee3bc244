/// \file
/// Captions, color bar, scale bar and warnings on pictures.
///
/// Text is drawn in DejaVu Sans (Debian: fonts-dejavu-core), the replacement that fontconfig
/// selects, or cairo's built-in font if there is none.
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
  std::optional<View> view{};           ///< As rendered; adds the patient's sides and a scale bar.
  bool converged = true;                ///< False: red bands across the picture.
};

/// Text on page and pictures of a prediction that did not converge.
inline constexpr const char* kNotConvergedBanner = "NOT CONVERGED \u2013 not a result";

/// Writes onto the picture and adds a strip below it, with color bar, scale bar and
/// kNotForClinicalUse. Only the caption, two letters in the lower corners, and the red bands can
/// cover anatomy.
///
/// \param picture     as rendered.
/// \param annotation  what is written.
/// \returns a picture of the same width and larger height; or kInvalidArgument for a malformed
///   picture, an empty color scale, an invalid view, or a height above kMaxPictureSide.
[[nodiscard]] Result<Picture> annotate(const Picture& picture, const Annotation& annotation);

/// Places pictures in a row, aligned at the top, each under its title.
///
/// \param pictures  one or more.
/// \param titles    one per picture, or none.
/// \returns the row; or kInvalidArgument if there is no picture, one is malformed, the number of
///   titles differs, or the row is larger than kMaxPictureSide.
[[nodiscard]] Result<Picture> side_by_side(std::span<const Picture> pictures,
                                           std::span<const std::string> titles);

}  // namespace lefort::report
