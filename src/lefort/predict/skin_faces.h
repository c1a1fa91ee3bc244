/// \file
/// Finds the faces of the tissue boundary that are skin.
#pragma once

#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/tissue_domain.h>

#include <vector>

namespace lefort::predict {

/// Boundary nodes within this distance of a cut plane lie in it. The mesher places them within
/// 0.01 mm.
inline constexpr double kPlaneTolerance_mm = 0.05;

/// Boundary faces whose nodes all lie on the skin or in a cut plane of the domain, at least one of
/// them on the skin; without the cut faces themselves (mesh/boundary_layer.h). Nodes on the skin
/// are those that are closer to the skin than to bone.
///
/// \param tissue           one block of tetrahedra.
/// \param domain           its cut planes are used, also those of the scan.
/// \param skin_L           skin surface.
/// \param segment_L        bone that moves.
/// \param remainder_L      other bone.
/// \param contact_snap_mm  nodes within this distance of the skin lie on it.
[[nodiscard]] std::vector<mesh::Face> skin_faces(const mesh::VolumeMesh& tissue,
                                                 const TissueDomain& domain,
                                                 const geometry::TriangleMesh& skin_L,
                                                 const geometry::TriangleMesh& segment_L,
                                                 const geometry::TriangleMesh& remainder_L,
                                                 double contact_snap_mm);

}  // namespace lefort::predict
