/// \file
/// A cutting guide: fits on bone, with a slot for the saw and holes for the drill.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/dental/cut_line.h>
#include <lefort/dental/insertion_fit.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::dental {

/// Where a guide is put.
struct GuideSite {
  static constexpr double kSaw_mm = 0.5;  ///< Of a thin reciprocating saw.
  const geometry::Bvh& bone;              ///< Before the cut, closed.
  const geometry::Bvh& cut_solid;         ///< Closed: contains the segment; its faces are the cut.
  double saw_mm = kSaw_mm;                ///< Thickness of the saw: outside of the solid.
  Vec3 outward_L = Vec3::UnitZ();         ///< Unit vector in which the guide is taken off.

  /// \returns the distance from the cut, positive on the side of the saw [mm].
  [[nodiscard]] double from_cut_mm(const Vec3& p_L) const {
    return cut_solid.signed_distance(p_L).distance_mm;
  }
};

struct GuideOptions {
  double clearance_mm = 0.1;       ///< Between bone and guide; 0 to 0.5.
  double thickness_mm = 3.0;       ///< Of the guide; 2 to 6.
  double width_mm = 9.0;           ///< On each side of the cut; 5 to 20.
  double slot_clearance_mm = 0.1;  ///< On each side of the saw; 0 to 0.5.
  double bridge_mm = 3.0;     ///< Without a slot, at the ends and between slots: 2 to 10, or the
                              ///< guide would fall in two.
  double max_slot_mm = 25.0;  ///< Length of a slot between bridges; 5 to 100.
  double voxel_mm = 0.25;     ///< Of the grid; 0.1 to 0.5.
};

/// A hole for a drill and later for the screw of a plate.
struct GuideHole {
  Vec3 point_L = Vec3::Zero();  ///< On the bone before the cut.
  Vec3 axis_L = Vec3::UnitZ();  ///< Unit length, out of the bone.
  bool is_on_segment = false;   ///< Otherwise on the bone that remains.
  double bone_mm = 0.0;         ///< Thickness of the bone along the axis, at most 20.
  double clear_mm = 0.0;        ///< From the drill to what it must not touch.
};

struct Guide {
  geometry::TriangleMesh surface_L;  ///< Closed.
  Index parts = 0;                   ///< Connected ones.
  double volume_ml = 0.0;
  double slot_mm = 0.0;  ///< Length of all slots.
  double slot_width_mm = 0.0;
  InsertionFit fit;  ///< Of the bone under the guide, without slots and holes.
};

/// Makes a guide around a line. Its body is what lies outside the bone, up to `thickness_mm` from
/// it and `width_mm` from the line. The bone, grown by the clearance, is removed together with all
/// that would meet it while the guide is put on, so that there are no undercuts (as make_splint()).
/// Slots follow the faces of the cut; bridges between them keep the guide in one piece.
///
/// \param site         bone and cut.
/// \param line         of the cut, visible from site.outward_L. \pre it has points.
/// \param holes        of the drill.
/// \param diameter_mm  of the holes.
/// \returns the guide, or
///   - kInvalidArgument  an option is out of range, or the grid would have more than 10^8 voxels;
///   - kMeshInvalid      nothing is left of the body;
///   - kCancelled        `progress` requested a stop.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<Guide> make_guide(const GuideSite& site, const CutLine& line,
                                       std::span<const GuideHole> holes, double diameter_mm,
                                       const GuideOptions& options,
                                       Progress& progress = Progress::none());

/// \returns nothing, or kInvalidArgument if an option is out of range.
[[nodiscard]] Result<void> check_guide(const GuideOptions& options);

}  // namespace lefort::dental
