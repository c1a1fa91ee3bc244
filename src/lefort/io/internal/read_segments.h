/// \file
/// The segments of a plan: osteotomy and path of each. Internal to io.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/internal/validated_json.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/landmarks.h>

#include <filesystem>
#include <vector>

namespace lefort::io::internal {

/// \param landmarks  name of a file, or an object of points by name.
/// \param folder     to which a relative file name refers.
/// \returns the landmarks, kPlanInvalid, or the errors of read_landmarks().
[[nodiscard]] Result<plan::Landmarks> read_plan_landmarks(const Json& landmarks,
                                                          const std::filesystem::path& folder);

/// \param segments   valid by the schema of plans.
/// \param landmarks  of the plan.
/// \param folder     to which relative file names refer.
/// \returns the segments, kPlanInvalid with the key, or the errors of reading a named file.
[[nodiscard]] Result<std::vector<plan::PlannedSegment>> read_segments(
    const Json& segments, const plan::Landmarks& landmarks, const std::filesystem::path& folder);

}  // namespace lefort::io::internal
