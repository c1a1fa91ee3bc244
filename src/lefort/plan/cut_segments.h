/// \file
/// All osteotomies of a plan, one after the other.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/perform_osteotomy.h>
#include <lefort/plan/plan.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::plan {

/// A piece of bone that is cut free and moved.
struct PlannedSegment {
  Osteotomy osteotomy;
  OsteotomyOptions cut;
  std::string from{};  ///< The earlier segment it is cut out of; empty: the bone that remains.
  geometry::RigidPath path{};
  bool is_distracted = false;  ///< New bone grows where it leaves: gaps are meant.
};

[[nodiscard]] std::vector<geometry::RigidPath> paths_of(std::span<const PlannedSegment> planned);

/// The skull in closed parts.
struct CutSegments {
  std::vector<geometry::TriangleMesh> segments_L;  ///< As many as planned, in their order.
  geometry::TriangleMesh remainder_L;
  std::vector<OsteotomyResult> cuts;  ///< What each cut told; the surfaces in it are left empty.
  double skull_volume_mm3 = 0.0;
  std::vector<double> volumes_mm3;  ///< Of the segments, as they are in the end.
  double remainder_volume_mm3 = 0.0;
  double kerf_volume_mm3 = 0.0;  ///< Of all cuts.
};

/// Cuts in the order of the plan; a later cut takes bone from what an earlier one left, or from the
/// earlier segment it names.
///
/// \returns what perform_osteotomy() returns; or kPlanInvalid if two segments have one name, or
///   `from` names none that stands before.
/// \note Volumes add up as those of perform_osteotomy() do.
[[nodiscard]] Result<CutSegments> cut_segments(const geometry::TriangleMesh& skull_L,
                                               std::span<const PlannedSegment> planned,
                                               Progress& progress = Progress::none());

/// Whether names and `from` of a plan's segments fit, before anything is cut; kPlanInvalid if not.
[[nodiscard]] Result<void> check_segments(std::span<const PlannedSegment> planned);

}  // namespace lefort::plan
