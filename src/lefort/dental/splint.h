/// \file
/// An occlusal splint between two arches.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/dental/engrave_text.h>
#include <lefort/dental/insertion_fit.h>
#include <lefort/dental/measure_occlusion.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::dental {

struct SplintOptions {
  double clearance_mm = 0.1;  ///< Between crowns and splint; 0 to 0.5.
  double cover_mm = 2.5;      ///< Height of the crowns that the splint covers; 0.5 to 6.
  double wall_mm = 2.5;       ///< Beyond the covered crowns, between the arches; 1 to 6.
  double rim_mm = 2.0;        ///< The same beside the crowns; 1 to wall_mm.
  double edge_mm = 0.8;       ///< Radius of its edges; 0 to half of rim_mm.
  double voxel_mm = 0.2;      ///< Of the grid; 0.1 to 0.5.
  TextMask text = {};         ///< Engraved into its front; rim_mm is then 1.6 or more.
};

/// A splint in frame L.
struct Splint {
  geometry::TriangleMesh surface_L;  ///< Closed.
  Index parts = 0;                   ///< Connected ones; 1 unless both arches have the same gap.
  double volume_ml = 0.0;
  /// Between the arches along the direction of insertion, where it covers one of them and the other
  /// one is opposite; negative: the splint has a hole there.
  double min_thickness_mm = 0.0;
  InsertionFit upper, lower;  ///< Of the vertices that it covers and that face the other arch.
};

/// Makes a splint. Its body is what lies within wall_mm of the covered crowns in the occlusal
/// plane, and between the cusps of both arches or up to cover_mm beyond them. Both arches, grown by
/// the clearance, are removed from it together with all that would meet them while the splint is
/// put on along the superior direction, so that it has no undercuts. Beside the crowns, beyond the
/// cusps of the arches, its wall is rim_mm. Edges are round, except those at the crowns.
///
/// \param upper_L, lower_L  arches in the planned position, outward; open or closed.
/// \param axes              of the arches.
/// \returns the splint, or
///   - kInvalidArgument  an option is out of range; see check_arch(); the gap of the arches exceeds
///     20 mm, or they overlap by more; the grid would have more than 10^8 voxels; or the covered
///     part spans less than 60 % of an arch, as if the directions were tilted; or the text has no
///     space;
///   - kMeshInvalid      nothing is left of the body;
///   - kCancelled        `progress` requested a stop.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<Splint> make_splint(const geometry::TriangleMesh& upper_L,
                                         const geometry::TriangleMesh& lower_L,
                                         const ArchAxes& axes, const SplintOptions& options = {},
                                         Progress& progress = Progress::none());

}  // namespace lefort::dental
