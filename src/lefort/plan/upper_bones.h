/// \file
/// The bones of the skull that the lower teeth can meet, at their poses at the end of the path.
#pragma once

#include <lefort/plan/condylar_axis.h>
#include <lefort/plan/cut_segments.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::plan {

/// Cuts the skull, which is given without the mandible, and returns each segment unmoved with its
/// pose at the end of its path: both halves of a maxilla, for example. Segments that contain no
/// bone of the skull are left out.
///
/// \param skull_L    closed, without the mandible.
/// \param planned    all segments, in the order of the plan.
/// \param upper_jaw  name of the segment with the upper teeth.
/// \param progress   of the cuts; may request a stop.
/// \returns the segments of the skull, then the bone that does not move; or kPlanInvalid if no
///   segment has that name, if that segment contains no bone of the skull, or as check_segments();
///   or the errors of perform_osteotomy() except kCutMissesBone.
[[nodiscard]] Result<std::vector<UpperBone>> upper_bones(geometry::TriangleMesh skull_L,
                                                         std::span<const PlannedSegment> planned,
                                                         const std::string& upper_jaw,
                                                         Progress& progress = Progress::none());

}  // namespace lefort::plan
