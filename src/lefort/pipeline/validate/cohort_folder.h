/// \file
/// The folders of a run over a cohort.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <span>
#include <vector>

namespace lefort::pipeline {

/// Whether `inner` is `outer` or lies inside it.
[[nodiscard]] bool is_inside(const std::filesystem::path& inner,
                             const std::filesystem::path& outer);

/// Lists the cases, creates the output folder and removes the reports of an earlier run from it.
///
/// \param cohort   folder of case folders.
/// \param output   folder of the reports.
/// \param reports  names of the files that the run writes.
/// \returns the case folders, ascending by name; the errors of list_cases(); kInvalidArgument if
///   one of `cohort` and `output` contains the other; or kFileUnwritable.
[[nodiscard]] Result<std::vector<std::filesystem::path>> open_cohort(
    const std::filesystem::path& cohort, const std::filesystem::path& output,
    std::span<const char* const> reports);

}  // namespace lefort::pipeline
