/// \file
/// What a cached stage is known by: the hash of all that went into it, and of the code's revision.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/predict/prediction_options.h>

#include <string>

namespace lefort::pipeline {

/// Each key covers every member of the options; one that is added does not compile until it does.
[[nodiscard]] std::string labels_key(const std::string& ct_sha256,
                                     const anatomy::SegmentationOptions& options);

[[nodiscard]] std::string field_key(const geometry::TriangleMesh& segment_B,
                                    const field::DistanceFieldOptions& options);

/// \param segment_L    the segment, or several as one mesh: where it lies decides which tissue is
///   meshed, and how finely.
/// \param remainder_L, capture_mm  count where options.skin does: bone is not skin.
[[nodiscard]] std::string tissue_key(const std::string& ct_sha256, const anatomy::LabelMap& labels,
                                     const anatomy::LevelOptions& levels,
                                     const geometry::TriangleMesh& segment_L,
                                     const geometry::TriangleMesh& remainder_L,
                                     const predict::TissueOptions& options, double capture_mm);

}  // namespace lefort::pipeline
