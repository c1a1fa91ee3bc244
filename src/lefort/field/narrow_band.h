/// \file
/// Exact signed distances at the lattice points near a surface: the paper's steps 1 to 3.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/sparse_lattice.h>
#include <lefort/geometry/triangle_mesh.h>

#include <limits>

namespace lefort::field {

/// Value of a lattice point beyond the reach, before its side is known.
inline constexpr float kFar = std::numeric_limits<float>::quiet_NaN();

/// Samples the signed distance at every lattice point within `reach_mm` of the surface; the other
/// points of the bricks touched are kFar.
///
/// \param mesh  in frame B; check_surface() holds, welded, not without area.
/// \returns kInvalidArgument if the points would not fit in memory; kCancelled.
/// \note A point's sign is that of the pseudonormal at its nearest feature. Among features equally
///   near, faces come before edges, edges before vertices, then the lower number: each brick visits
///   its features in that order and a later one must be strictly nearer, so threads do not matter.
[[nodiscard]] Result<SparseLattice> sample_narrow_band(const geometry::TriangleMesh& mesh,
                                                       const FieldFrame& frame, double reach_mm,
                                                       Progress& progress);

}  // namespace lefort::field
