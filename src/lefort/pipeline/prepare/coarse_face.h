/// \file
/// Options of a coarse model of the face, for many solves.
#pragma once

#include <lefort/predict/predict_face.h>

namespace lefort::pipeline {

/// A coarse mesh of linear elements without separate skin and mucosa; materials of the deep tissue
/// are unchanged.
///
/// \param fine  of the plan.
/// \returns elements of at least 8 mm near the segments and 12 mm far from them.
[[nodiscard]] predict::TissueOptions coarse_tissue(const predict::TissueOptions& fine);

}  // namespace lefort::pipeline
