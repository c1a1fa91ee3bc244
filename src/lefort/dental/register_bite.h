/// \file
/// The occlusion that bite scans show.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/dental/measure_occlusion.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <vector>

namespace lefort::dental {

/// How one bite scan fits.
struct BiteFit {
  RigidTransform X_L_bite = RigidTransform::Identity();  ///< Maps the bite scan to the upper arch.
  double upper_rms_mm = 0.0, lower_rms_mm = 0.0;         ///< Of the distances of its vertices.
  /// Of up to 400 of its vertices, at the first alignment: within 0.5 mm of one of the arches.
  double fraction = 0.0;
};

struct Bite {
  RigidTransform X_L_lower = RigidTransform::Identity();  ///< Movement of the lower arch.
  std::vector<BiteFit> fits;                              ///< In the order of the bite scans.
};

/// Finds the position of the lower arch from scans of the teeth in occlusion, seen from the cheek,
/// without initial alignment.
///
/// The principal axes of the scan are turned to 144 orientations at 13 places of the upper arch.
/// From each, short registrations (align_coarsely()); the best ends are continued with the lower
/// arch, and the one is taken in which most of the scan lies on both arches. Then the part of the
/// scan that is closer to the upper arch is registered with it (compare/register_surface.h), and
/// the other parts of all scans together with the lower arch.
///
/// \param upper_L  the upper arch.
/// \param lower_L  the lower one; up to 15 mm from its position in occlusion.
/// \param axes     of the arches.
/// \param bites    one or more, for example right and left; each in any frame [mm].
/// \returns the movement, or
///   - kInvalidArgument  a scan is not 8 to 150 mm long, or see check_arch();
///   - kNotConverged     a scan does not fit both arches: less than 60 % of it lies on them, or
///     less than 15 % on one of them; or the scans show different occlusions;
///   - kCancelled        `progress` requested a stop.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<Bite> register_bite(const geometry::TriangleMesh& upper_L,
                                         const geometry::TriangleMesh& lower_L,
                                         const ArchAxes& axes,
                                         std::span<const geometry::TriangleMesh> bites,
                                         Progress& progress = Progress::none());

}  // namespace lefort::dental
