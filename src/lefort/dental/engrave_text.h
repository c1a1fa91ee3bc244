/// \file
/// Text on the front of a splint.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/image/volume.h>

#include <vector>

namespace lefort::dental {

/// Letters as pixels, cropped to the ink.
struct TextMask {
  Index width = 0, height = 0;  ///< Pixels.
  double pixel_mm = 0.1;        ///< Edge of a pixel, at the nominal size of the letters.
  std::vector<float> coverage;  ///< 0 to 1; rows from the top, pixels from the left.
};

/// Engraves letters into the front of a body. They are read from the front, along its outline, in
/// the middle of its height. Letters that are too large are reduced to 60 % of their size at the
/// most.
///
/// \param level     of the body, positive inside [mm]; i of its grid is the patient's left, j
///   posterior, k superior.
/// \param text      the letters; nothing without ink.
/// \param depth_mm  of the letters.
/// \returns nothing; or kInvalidArgument if the letters have no space or the body is empty.
[[nodiscard]] Result<void> engrave_front(image::ScalarVolume& level, const TextMask& text,
                                         double depth_mm);

}  // namespace lefort::dental
