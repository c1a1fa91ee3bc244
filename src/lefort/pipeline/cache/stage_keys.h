/// \file
/// Keys of cached stages: hashes of their inputs and of the revision of their code.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/predict/prediction_options.h>

#include <string>

namespace lefort::pipeline {

/// Each key covers every member of the options that can change the result; a new member fails to
/// compile until the key names it.
[[nodiscard]] std::string labels_key(const std::string& ct_sha256,
                                     const anatomy::SegmentationOptions& options);

[[nodiscard]] std::string field_key(const geometry::TriangleMesh& segment_B,
                                    const field::DistanceFieldOptions& options);

/// \param segment_L    all segments as one mesh: their position determines the meshed region
///   and the element size.
/// \param remainder_L, contact_snap_mm  used only with options.skin.
[[nodiscard]] std::string tissue_key(const std::string& ct_sha256, const anatomy::LabelMap& labels,
                                     const anatomy::LevelOptions& levels,
                                     const geometry::TriangleMesh& segment_L,
                                     const geometry::TriangleMesh& remainder_L,
                                     const predict::TissueOptions& options, double contact_snap_mm);

}  // namespace lefort::pipeline
