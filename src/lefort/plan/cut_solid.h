/// \file
/// The solids by which an osteotomy cuts bone. Used in this layer and for cutting guides.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/convex_solid.h>
#include <lefort/plan/plan.h>

#include <vector>

namespace lefort::plan {

/// Limit of the kerf; no surgical saw blade is thicker.
inline constexpr double kMaxKerf_mm = 5.0;

/// \param osteotomy  of any kind.
/// \returns nothing, or kPlanInvalid with the name of the segment and the reason (see
///   perform_osteotomy()).
[[nodiscard]] Result<void> check_osteotomy(const Osteotomy& osteotomy);

/// \param osteotomy  checked by check_osteotomy().
/// \returns whether it consists of bounded planes (sheets).
[[nodiscard]] bool is_of_sheets(const Osteotomy& osteotomy);

/// \param osteotomy  checked by check_osteotomy().
/// \returns whether it consists of one region of unbounded planes; only its kerf needs a solid.
[[nodiscard]] bool is_of_planes(const Osteotomy& osteotomy);

/// \param planes  unbounded.
/// \returns the half-space on the segment's side of each plane.
[[nodiscard]] std::vector<mesh::HalfSpace> half_spaces_of(const std::vector<CutPlane>& planes);

/// \param osteotomy  checked by check_osteotomy(), not of sheets.
/// \param box        bounds the solid.
/// \param grow_mm    outward offset of the faces [mm], >= 0.
/// \returns the solid within the cuts, a closed surface; or
///   - kInvalidArgument  a curve crosses itself after `grow_mm` is applied;
///   - kMeshingFailed    the solids of curves or regions cannot be combined.
[[nodiscard]] Result<geometry::TriangleMesh> cut_solid(const Osteotomy& osteotomy, const Box3& box,
                                                       double grow_mm);

/// \param osteotomy     of sheets.
/// \param thickness_mm  of each slab, > 0.
/// \returns the union of the slabs behind the bounded planes, seen from the segment; or
///   kMeshingFailed.
[[nodiscard]] Result<geometry::TriangleMesh> sheet_solid(const Osteotomy& osteotomy,
                                                         double thickness_mm);

}  // namespace lefort::plan
