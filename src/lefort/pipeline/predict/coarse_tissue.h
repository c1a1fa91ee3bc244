/// \file
/// A coarse mesh for what is predicted many times.
#pragma once

#include <lefort/predict/prediction_options.h>

#include <algorithm>

namespace lefort::pipeline {

/// Linear elements of 8 mm near the segments and 12 mm far from them, or those of the plan if they
/// are larger; without finer elements at lips and nose, without mucosa.
///
/// \param has_skin  keeps the layer of skin, if the plan has one.
[[nodiscard]] inline predict::TissueOptions coarse_tissue(const predict::TissueOptions& fine,
                                                          bool has_skin) {
  constexpr double kElementSize_mm = 8.0, kFarElementSize_mm = 12.0;
  predict::TissueOptions options = fine;
  options.element_size_mm = std::max(fine.element_size_mm, kElementSize_mm);
  options.far_element_size_mm = std::max(fine.far_element_size_mm, kFarElementSize_mm);
  options.element_order = 1;
  if (!has_skin) options.skin.reset();
  options.mucosa.reset();
  options.face.reset();
  return options;
}

}  // namespace lefort::pipeline
