/// \file
/// Finds the maximum intercuspation of two arches.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/dental/measure_occlusion.h>
#include <lefort/geometry/triangle_mesh.h>

#include <optional>

namespace lefort::dental {

/// What an occlusion has to be, beside maximum intercuspation. A request is a cost: where the teeth
/// do not allow it, the occlusion differs from it.
struct OcclusionRequests {
  std::optional<double> overjet_mm, overbite_mm;  ///< As in Occlusion.
  std::optional<double> midline_mm;  ///< As OcclusalRelations::midline_mm; needs both midlines.
  Vec3 upper_midline_L = Vec3::Zero();
  Vec3 lower_midline_L = Vec3::Zero();  ///< At the start.
};

struct OcclusionOptions {
  /// Between the five starts along each axis of the occlusal plane; 0 to 5.
  double shift_mm = 2.0;
  double yaw_deg = 3.0;  ///< Between the five starts about the superior direction; 0 to 10.
  /// The lower arch is a piece, close to its occlusion, which would fit at other teeth, too: the
  /// search starts from the given position only, with exact gaps and a width of 2 mm, and 0.02 of
  /// the squared displacement is added to the cost, which holds the piece where contacts do not.
  bool is_close = false;
  OcclusionRequests requests = {};
};

inline constexpr double kMaxRequest_mm = 10.0;  ///< Of a requested overjet, overbite or midline.

/// Moves the lower arch to the position in which both arches are as close as possible, without
/// penetration by more than kMaxOcclusalPenetration_mm (\cite nadjmi2010, \cite chang2010,
/// \cite deng2020).
///
/// From starts on a grid around the given position the lower arch settles: it rises and tilts until
/// it lies on the upper teeth. Then the distances between facing surfaces are minimized, from both
/// arches, with weights of Geman and McClure that become narrower and a penalty of penetration that
/// grows (\cite blake1987): damped Gauss-Newton steps of six unknowns, on GapGrid. Of the ends
/// within 12 mm, the best four are refined with exact gaps, and the one with the lowest cost is
/// taken.
///
/// Requests are added to the cost as squared differences [mm^2] times the area of the lower arch:
/// in the last stage a difference of 0.15 mm costs as much as all contacts. The starts are shifted
/// by the differences in the occlusal plane.
///
/// \param upper_L   crowns of the upper arch; open or closed.
/// \param lower_L   crowns of the lower arch at the start.
/// \param axes      of the arches.
/// \param options   the starts.
/// \returns the occlusion, or
///   - kInvalidArgument  an option is out of range or not finite; see check_arch();
///   - kNotConverged     no occlusion is found within 12 mm, or only with penetration;
///   - kCancelled        `progress` requested a stop.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<Occlusion> find_occlusion(const geometry::TriangleMesh& upper_L,
                                               const geometry::TriangleMesh& lower_L,
                                               const ArchAxes& axes,
                                               const OcclusionOptions& options = {},
                                               Progress& progress = Progress::none());

}  // namespace lefort::dental
