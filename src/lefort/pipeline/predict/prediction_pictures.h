/// \file
/// Pictures of a prediction: the face before and after, the displacement of the skin, the bones.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/prepare/prepare_case.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

enum class PictureKind { kBefore, kAfter, kDisplacement, kBones };

struct PredictionPicture {
  PictureKind kind;
  std::string file;   ///< Name without folder, for example "after_front.png".
  std::string title;  ///< "Predicted, front".
  std::string png;    ///< The file's bytes.
};

/// Draws before and after from the same cameras, the displacement in colors, and the cut skull.
///
/// \param skin_displacement_mm  one per vertex of prepared.skin_L.
/// \param segments              at the end of their paths.
/// \returns the pictures, or the errors of report::SurfaceScene.
[[nodiscard]] Result<std::vector<PredictionPicture>> draw_prediction(
    const PreparedCase& prepared, std::span<const Vec3> skin_displacement_mm,
    std::span<const predict::SegmentStep> segments, Progress& progress);

}  // namespace lefort::pipeline
