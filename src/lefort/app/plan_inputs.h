/// \file
/// The files that a plan names.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/plan_file.h>

#include <filesystem>
#include <optional>
#include <string>

namespace lefort::app {

/// The scan that `given` names, or else the plan.
///
/// \returns kPlanInvalid if neither does, kFileNotFound if it is not there.
[[nodiscard]] Result<std::filesystem::path> scan_of(
    const std::filesystem::path& plan_file, const io::PlanFile& plan,
    const std::optional<std::filesystem::path>& given);

/// The plan's text with its files named as seen from the folder the copy goes to.
[[nodiscard]] std::string portable_plan(const std::string& text,
                                        const std::filesystem::path& plan_file,
                                        const std::filesystem::path& ct,
                                        const std::filesystem::path& folder);

}  // namespace lefort::app
