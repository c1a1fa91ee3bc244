/// \file
/// The mesh of the tissue domain: fine where bone moves it, coarse at the rim.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/tissue_domain.h>

#include <array>
#include <cstdint>

namespace lefort::predict {

/// How far the mesh may be from the level's surface, as a part of the element size.
inline constexpr double kSurfaceDistanceFraction = 0.15;

/// What the elements' numbers of regions mean.
namespace regions {
inline constexpr std::int32_t kInside = 0;  ///< Connective tissue, fat and all that is not told.
inline constexpr std::int32_t kSkin = 1;
inline constexpr std::int32_t kMucosa = 2;
inline constexpr std::int32_t kMuscle = 3;

struct RegionName {
  std::int32_t region;
  const char* name;
};

inline constexpr std::array<RegionName, 4> kNames{
    {{kInside, "inside"}, {kSkin, "skin"}, {kMucosa, "mucosa"}, {kMuscle, "muscle"}}};
}  // namespace regions

/// No element of a mesh with skin may have a smaller scaled Jacobian.
inline constexpr double kMinJacobian = 0.05;

/// \param segment_L  as make_tissue_domain() has it.
/// \returns tetrahedra without sets, or as mesh::generate_tets.
/// \pre !options.skin
[[nodiscard]] Result<mesh::VolumeMesh> mesh_tissue(const TissueDomain& domain,
                                                   const geometry::TriangleMesh& segment_L,
                                                   const TissueOptions& options,
                                                   Progress& progress = Progress::none());

/// The same under layers of wedges for skin (mesh/boundary_layer.h): tetrahedra, pyramids, wedges.
///
/// \param skin_L, remainder_L  where skin is, and where bone: skin_faces().
/// \param capture_mm           likewise.
/// \returns a mesh without sets, no element below kMinJacobian; or as mesh::generate_tets and
///   mesh::add_boundary_layer, or
///   - kAnatomyMissing  no skin bounds the tissue;
///   - kMeshingFailed   an element is worse than that; its place is told.
/// \pre options.skin
[[nodiscard]] Result<mesh::VolumeMesh> mesh_tissue_and_skin(
    const TissueDomain& domain, const geometry::TriangleMesh& skin_L,
    const geometry::TriangleMesh& segment_L, const geometry::TriangleMesh& remainder_L,
    const TissueOptions& options, double capture_mm, Progress& progress = Progress::none());

}  // namespace lefort::predict
