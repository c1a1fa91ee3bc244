/// \file
/// Distance field of a bone, read from the cache or built.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/plan_file.h>
#include <lefort/pipeline/cache/stage_cache.h>

#include <filesystem>
#include <memory>
#include <string>

namespace lefort::pipeline {

/// Options of the field of a regularized bone, or of a bone that contact reads itself.
///
/// \param surface_B  of either.
[[nodiscard]] field::DistanceFieldOptions contact_field_options(
    const io::PlanFile& plan, const geometry::TriangleMesh& surface_B);

/// Options of the field of a bone before its obstacle exists. It is smooth only if contact will
/// read the bone itself.
[[nodiscard]] field::DistanceFieldOptions bone_field_options(
    const io::PlanFile& plan, const geometry::TriangleMesh& surface_B);

/// \param name       of the bone, for the stage and the file.
/// \param surface_B  of the bone.
/// \returns the field in the frame of `surface_B`, or the errors of field::build_distance_field().
[[nodiscard]] Result<std::shared_ptr<const field::DistanceField>> find_field(
    const std::string& name, const geometry::TriangleMesh& surface_B,
    const field::DistanceFieldOptions& options, const StageCache& cache, Progress& progress);

/// Path of the field in the cache.
[[nodiscard]] std::filesystem::path field_file(const std::string& name,
                                               const geometry::TriangleMesh& surface_B,
                                               const field::DistanceFieldOptions& options,
                                               const StageCache& cache);

}  // namespace lefort::pipeline
