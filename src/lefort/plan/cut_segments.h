/// \file
/// Performs all osteotomies of a plan in sequence.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/perform_osteotomy.h>
#include <lefort/plan/plan.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::plan {

/// A mobilized segment: its osteotomy and its motion.
struct PlannedSegment {
  Osteotomy osteotomy;
  OsteotomyOptions cut;
  std::string cut_from{};  ///< The earlier segment it is cut from; empty: the remainder.
  geometry::RigidPath path{};
  bool is_distracted = false;  ///< Distraction osteogenesis: bone grows in the gap.
  /// The segment is the whole mandible. Nothing is cut: of the osteotomy only the name is used. For
  /// autorotation, and for cases given as surfaces whose osteotomy lines are not known.
  bool is_whole_mandible = false;
  /// The segment is the whole piece of bone on which this point lies, without a cut: for example a
  /// proximal segment, which remains as a piece of its own after the sagittal split. Pieces smaller
  /// than cut.min_piece_ml are not considered. As for the whole mandible, only the name of the
  /// osteotomy is used.
  std::optional<Vec3> piece_at_L{};
};

/// \param planned  the segments.
/// \returns the path of each segment.
[[nodiscard]] std::vector<geometry::RigidPath> paths_of(std::span<const PlannedSegment> planned);

/// The skull after all osteotomies, as closed surfaces.
struct CutSegments {
  std::vector<geometry::TriangleMesh> segments_L;  ///< In the order of the plan.
  geometry::TriangleMesh remainder_L;
  std::vector<OsteotomyResult> cuts;  ///< The result of each cut, without surfaces of parts.
  double skull_volume_mm3 = 0.0;      ///< Before all cuts; with the mandible, if it was given.
  std::vector<double> volumes_mm3;    ///< Of the segments, after all cuts.
  double remainder_volume_mm3 = 0.0;
  double kerf_volume_mm3 = 0.0;      ///< Of all cuts.
  double left_out_volume_mm3 = 0.0;  ///< Of all cuts: fragments without an owner.
};

/// Performs the osteotomies in the order of the plan. Each one cuts the remainder of the earlier
/// ones, or the earlier segment that `cut_from` names.
///
/// \param skull_L   closed; several bodies and cavities are allowed.
/// \param planned   the segments.
/// \param progress  of each cut; may request a stop.
/// \returns the parts; or the errors of perform_osteotomy(); or kAnatomyMissing if a segment is the
///   whole mandible; or kPlanInvalid if two segments have the same name, or `cut_from` does not
///   name an earlier segment.
/// \note Volumes add up within the tolerance of perform_osteotomy().
[[nodiscard]] Result<CutSegments> cut_segments(const geometry::TriangleMesh& skull_L,
                                               std::span<const PlannedSegment> planned,
                                               Progress& progress = Progress::none());

/// As above, for a plan in which one segment may be the whole mandible.
///
/// \param skull_L     closed; without the mandible if `mandible_L` is given.
/// \param mandible_L  closed; null if the mandible is part of `skull_L`.
/// \returns as above; also kAnatomyMissing if a segment is the whole mandible and `mandible_L` is
///   null or taken by an earlier segment; and kCutMissesBone if no piece lies within 5 mm of
///   `piece_at_L`, if there is only one piece, so that nothing would remain, or if the piece is
///   larger than all other bone.
[[nodiscard]] Result<CutSegments> cut_segments(const geometry::TriangleMesh& skull_L,
                                               const geometry::TriangleMesh* mandible_L,
                                               std::span<const PlannedSegment> planned,
                                               Progress& progress = Progress::none());

/// \returns whether a segment is the whole mandible.
[[nodiscard]] bool takes_mandible(std::span<const PlannedSegment> planned);

/// Checks the names and `cut_from` of all segments.
///
/// \param planned  the segments, in the order of the plan.
/// \returns nothing, or kPlanInvalid as cut_segments() does.
[[nodiscard]] Result<void> check_segments(std::span<const PlannedSegment> planned);

}  // namespace lefort::plan
