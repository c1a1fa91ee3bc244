/// \file
/// Options of the distance field of a bone that contact uses.
#pragma once

#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/predict/prediction_options.h>

namespace lefort::predict {

/// Penetration within which contact must measure the distance to a bone [mm]: 3 mm, plus half an
/// element for the depth of the mesh in the bone at rest, plus half of the longest increment
/// (load_levels.h).
///
/// \param tissue    its element size is used.
/// \param obstacle  of the plan's contact; it determines the longest increment.
[[nodiscard]] double contact_band_mm(const TissueOptions& tissue, Obstacle obstacle);

/// Chooses the band of a field if `options` do not. Tissue must stay within the band. The band is
/// therefore contact_band_mm(), but at most 0.4 of the longest side of the bone's box.
///
/// \param options    of the plan.
/// \param surface_B  of the bone.
/// \param tissue     its element size is used.
/// \param obstacle   as for contact_band_mm().
/// \returns the options with band_mm; unchanged if band_mm or side_mm was given, or if the default
///   band is not narrower.
[[nodiscard]] field::DistanceFieldOptions contact_field_options(
    field::DistanceFieldOptions options, const geometry::TriangleMesh& surface_B,
    const TissueOptions& tissue, Obstacle obstacle);

}  // namespace lefort::predict
