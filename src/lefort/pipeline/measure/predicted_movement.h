/// \file
/// The movement of all points that a prediction knows.
#pragma once

#include <lefort/anatomy/warp_volume.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct PredictedMovement {
  std::vector<anatomy::MovedPoint> points;  ///< Soft tissue and bone.
  std::vector<Vec3> tissue_L;  ///< Nodes of the soft tissue before the movement, without bone.
  std::string ct_sha256;       ///< Of the scan; empty if the prediction does not state it.
};

/// Reads the last step of a prediction: the nodes of the tissue mesh, and the vertices of moved
/// segments and of the bone that remains.
///
/// \param folder  of predict_case().
/// \returns the movement; or kFileNotFound without a converged prediction; kFileCorrupt,
///   kFileUnsupported as io::predicted_poses(); or the errors of io::read_vtu() and
///   io::read_surface().
[[nodiscard]] Result<PredictedMovement> predicted_movement(const std::filesystem::path& folder,
                                                           Progress& progress);

}  // namespace lefort::pipeline
