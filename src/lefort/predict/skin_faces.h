/// \file
/// Which part of the tissue's boundary is skin, face by face.
#pragma once

#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/tissue_domain.h>

#include <vector>

namespace lefort::predict {

/// Nodes of the boundary this near to a side of the domain lie in it; they lie on the level within
/// 0.01 mm.
inline constexpr double kPlaneTolerance_mm = 0.05;

/// Boundary faces whose nodes all lie on the skin, nearer to it than to bone, or in a side of the
/// domain; but not those of the sides themselves (mesh/boundary_layer.h).
///
/// \param tissue      one block of tetrahedra.
/// \param capture_mm  nodes nearer than this to the skin lie on it.
[[nodiscard]] std::vector<mesh::Face> skin_faces(const mesh::VolumeMesh& tissue,
                                                 const TissueDomain& domain,
                                                 const geometry::TriangleMesh& skin_L,
                                                 const geometry::TriangleMesh& segment_L,
                                                 const geometry::TriangleMesh& remainder_L,
                                                 double capture_mm);

}  // namespace lefort::predict
