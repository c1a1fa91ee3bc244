#include <lefort/pipeline/prepare/coarse_face.h>

#include <algorithm>

namespace lefort::pipeline {

predict::TissueOptions coarse_tissue(const predict::TissueOptions& fine) {
  constexpr double kElementSize_mm = 8.0, kFarElementSize_mm = 12.0;
  predict::TissueOptions options = fine;
  options.element_size_mm = std::max(fine.element_size_mm, kElementSize_mm);
  options.far_element_size_mm = std::max(fine.far_element_size_mm, kFarElementSize_mm);
  options.element_order = 1;
  options.skin.reset();
  options.mucosa.reset();
  options.face.reset();
  return options;
}

}  // namespace lefort::pipeline
