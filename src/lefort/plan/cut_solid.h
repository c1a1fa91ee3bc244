/// \file
/// The solids that an osteotomy cuts with. For this layer.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/convex_solid.h>
#include <lefort/plan/plan.h>

#include <vector>

namespace lefort::plan {

inline constexpr double kWidestKerf_mm = 5.0;  ///< No saw is wider.

/// \returns kPlanInvalid, which names the osteotomy and what is wrong with it (see
///   perform_osteotomy()).
[[nodiscard]] Result<void> check_osteotomy(const Osteotomy& osteotomy);

/// Whether it is of bounded planes, so of sheets. \pre check_osteotomy()
[[nodiscard]] bool is_of_sheets(const Osteotomy& osteotomy);

/// Whether it is of unbounded planes alone, which need no solid.
[[nodiscard]] bool is_of_planes(const Osteotomy& osteotomy);

[[nodiscard]] std::vector<mesh::HalfSpace> half_spaces_of(const std::vector<CutPlane>& planes);

/// What lies within the osteotomy, and in `box`; its walls moved outwards.
///
/// \pre check_osteotomy(), not is_of_sheets().
/// \returns kMeshingFailed or kPlanInvalid if the cuts do not make a solid.
[[nodiscard]] Result<geometry::TriangleMesh> cut_solid(const Osteotomy& osteotomy, const Box3& box,
                                                       double grow_mm);

/// The slabs behind bounded planes, together. \pre is_of_sheets()
[[nodiscard]] Result<geometry::TriangleMesh> sheet_solid(const Osteotomy& osteotomy,
                                                         double thickness_mm);

}  // namespace lefort::plan
