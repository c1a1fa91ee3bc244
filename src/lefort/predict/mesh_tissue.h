/// \file
/// Meshes the tissue domain: fine near the segment (also at lips and nose, if the options have
/// FaceSize), coarse at the border of the region.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/tissue_domain.h>

#include <array>
#include <cstdint>

namespace lefort::predict {

/// Tolerance between mesh and zero surface of the level, as a fraction of the smallest element
/// size.
inline constexpr double kSurfaceDistanceFraction = 0.15;

/// Region numbers of elements.
namespace regions {
inline constexpr std::int32_t kDeepTissue =
    0;  ///< Connective tissue, fat, and tissue that is not segmented.
inline constexpr std::int32_t kSkin = 1;
inline constexpr std::int32_t kMucosa = 2;
inline constexpr std::int32_t kMuscle = 3;

struct RegionName {
  std::int32_t region;
  const char* name;
};

inline constexpr std::array<RegionName, 4> kNames{
    {{kDeepTissue, "inside"}, {kSkin, "skin"}, {kMucosa, "mucosa"}, {kMuscle, "muscle"}}};
}  // namespace regions

/// Min scaled Jacobian of a mesh with skin.
inline constexpr double kMinJacobian = 0.05;

/// Meshes the domain with tetrahedra.
///
/// \param domain     region to mesh.
/// \param segment_L  as in make_tissue_domain(); elements have options.element_size_mm there.
/// \param options    element sizes and margin.
/// \param progress   may stop the meshing.
/// \returns tetrahedra without sets; or as mesh::generate_tets.
/// \pre !options.skin
[[nodiscard]] Result<mesh::VolumeMesh> mesh_tissue(const TissueDomain& domain,
                                                   const geometry::TriangleMesh& segment_L,
                                                   const TissueOptions& options,
                                                   Progress& progress = Progress::none());

/// Meshes the domain with layers of wedges for skin (mesh/boundary_layer.h) on tetrahedra: the mesh
/// has tetrahedra, pyramids and wedges.
///
/// \param domain           region to mesh.
/// \param skin_L           skin surface, see skin_faces().
/// \param segment_L        as in make_tissue_domain().
/// \param remainder_L      other bone, see skin_faces().
/// \param options          element sizes, margin and skin.
/// \param contact_snap_mm  see skin_faces().
/// \param progress         may stop the meshing.
/// \returns a mesh without sets and without elements below kMinJacobian; or as mesh::generate_tets
///   and mesh::add_boundary_layer, or
///   - kAnatomyMissing  no skin bounds the tissue;
///   - kMeshingFailed   an element is below kMinJacobian; the message has its position.
/// \pre options.skin
[[nodiscard]] Result<mesh::VolumeMesh> mesh_tissue_and_skin(
    const TissueDomain& domain, const geometry::TriangleMesh& skin_L,
    const geometry::TriangleMesh& segment_L, const geometry::TriangleMesh& remainder_L,
    const TissueOptions& options, double contact_snap_mm, Progress& progress = Progress::none());

}  // namespace lefort::predict
