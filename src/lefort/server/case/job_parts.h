/// \file
/// What jobs of several kinds have in common.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>
#include <lefort/server/case/case_folder.h>
#include <lefort/server/case/jobs.h>

#include <filesystem>
#include <optional>

namespace lefort::server {

/// The outcome without paths, which a page does not need.
[[nodiscard]] JobOutcome reported(const pipeline::Summary& summary);

/// \returns nothing, or kFileNotFound if the case has no scan.
[[nodiscard]] Result<void> check_scan(const CaseFolder& folder);

/// \returns nothing, or kFileNotFound if the case has no scan or plan, or the errors of
///   check_files_of_plan().
[[nodiscard]] Result<void> check_plan(const CaseFolder& folder);

/// Notes which of landmarks, plan and painted boundary conditions were made on another scan, and
/// whether the plan keeps canals of nerves free that are out of date.
void note_other_scans(const CaseFolder& folder, Progress& progress);

/// Whether an upload is a surface; otherwise it is a scan.
[[nodiscard]] bool is_surface(const std::filesystem::path& upload);

/// The inputs recorded for a result: those before its computation, with an invalid fingerprint
/// where one has changed since. Such an input may or may not have been read: the result matches no
/// input, not even if the change is undone.
[[nodiscard]] CaseFolder::Inputs inputs_read(CaseFolder::Inputs before,
                                             const std::optional<CaseFolder::Inputs>& now);

}  // namespace lefort::server
