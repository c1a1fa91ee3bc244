/// \file
/// The mesh of the tissue domain: fine where bone moves it, coarse at the rim.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/tissue_domain.h>

namespace lefort::predict {

/// How far the mesh may be from the level's surface, as a part of the element size.
inline constexpr double kSurfaceDistanceShare = 0.15;

/// \returns tetrahedra without sets, or as mesh::generate_tets.
[[nodiscard]] Result<mesh::VolumeMesh> mesh_tissue(const TissueDomain& domain,
                                                   const geometry::TriangleMesh& segment_L,
                                                   const TissueOptions& options,
                                                   Progress& progress = Progress::none());

}  // namespace lefort::predict
