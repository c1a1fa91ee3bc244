/// \file
/// Finds the maximum intercuspation of two arches.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <vector>

namespace lefort::dental {

/// Directions of the arches in frame L: unit vectors, perpendicular to each other.
struct ArchAxes {
  Vec3 superior_L = Vec3::UnitZ();   ///< Perpendicular to the occlusal plane.
  Vec3 anterior_L = -Vec3::UnitY();  ///< In the mid-sagittal plane.
  [[nodiscard]] Vec3 left_L() const { return anterior_L.cross(superior_L); }
};

struct OcclusionOptions {
  double shift_mm = 2.0;  ///< Between starts, in the occlusal plane; 0 to 5.
  double yaw_deg = 3.0;   ///< Between starts, about the superior direction; 0 to 10.
};

/// Contact of the arches in occlusion.
struct OcclusalContacts {
  double left_mm2 = 0.0, right_mm2 = 0.0;  ///< Area of lower teeth within kContactGap_mm.
  Index patches = 0;                       ///< Connected patches of these areas.
  double max_penetration_mm = 0.0;
};
inline constexpr double kContactGap_mm = 0.2;
inline constexpr double kMaxOcclusalPenetration_mm = 0.1;

/// An occlusion.
struct Occlusion {
  RigidTransform X_L_lower = RigidTransform::Identity();  ///< Movement of the lower arch.
  OcclusalContacts contacts;
  /// Of the edges of the central incisors, upper relative to lower [mm]: to anterior and to
  /// inferior (overbite), edge to edge; NaN if the edges found are not opposite.
  double overjet_mm = 0.0, overbite_mm = 0.0;
  /// Gap of each vertex of the lower arch [mm], negative if it penetrates; NaN further than 3 mm
  /// from the upper one.
  std::vector<double> gaps_mm;
};

/// Moves the lower arch to the position in which both arches are as close as possible, without
/// penetration by more than kMaxOcclusalPenetration_mm (\cite nadjmi2010, \cite chang2010,
/// \cite deng2020).
///
/// From each of 27 starts around the given position the distances between facing surfaces are
/// minimized, from both arches, with weights of Geman and McClure that become narrower and a
/// penalty of penetration that grows (\cite blake1987): Gauss-Newton steps of six unknowns. Of the
/// ends within 9 mm, that with the largest facing area is refined.
///
/// \param upper_L   crowns of the upper arch; open or closed.
/// \param lower_L   crowns of the lower arch at the start.
/// \param axes      of the arches.
/// \param options   the starts.
/// \returns the occlusion, or
///   - kInvalidArgument  an option is out of range, or a surface is unusable;
///   - kNotConverged     no occlusion is found within 9 mm, or only with penetration, as if
///     triangles face inward;
///   - kCancelled        `progress` requested a stop.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<Occlusion> find_occlusion(const geometry::TriangleMesh& upper_L,
                                               const geometry::TriangleMesh& lower_L,
                                               const ArchAxes& axes,
                                               const OcclusionOptions& options = {},
                                               Progress& progress = Progress::none());

/// \param X_LB  position of the lower arch.
/// \returns the contacts and distances there.
[[nodiscard]] Occlusion measure_occlusion(const geometry::TriangleMesh& upper_L,
                                          const geometry::TriangleMesh& lower_L,
                                          const RigidTransform& X_LB, const ArchAxes& axes);

}  // namespace lefort::dental
