/// \file
/// The segments of a plan: what frees each, and its way. For the .cpp files of this layer alone.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/internal/validated_json.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/landmarks.h>

#include <filesystem>
#include <vector>

namespace lefort::io::internal {

/// \param landmarks  a file's name, or points by name.
/// \param folder     relative names of files are taken from it.
/// \returns kPlanInvalid or what reading the file returns.
[[nodiscard]] Result<plan::Landmarks> read_plan_landmarks(const Json& landmarks,
                                                          const std::filesystem::path& folder);

/// \param segments   passed the plan's schema.
/// \param landmarks  of the plan.
/// \returns kPlanInvalid naming the key, or what reading a file that is named returns.
[[nodiscard]] Result<std::vector<plan::PlannedSegment>> read_segments(
    const Json& segments, const plan::Landmarks& landmarks, const std::filesystem::path& folder);

}  // namespace lefort::io::internal
