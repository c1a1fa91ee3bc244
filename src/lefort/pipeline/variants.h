/// \file
/// Several plans of one case, side by side.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <vector>

namespace lefort::pipeline {

struct VariantsJob {
  /// One folder for each plan, named by it. It has `check/` of check_plan_file() and may have
  /// `prediction/` of predict_case(). Two to four.
  std::vector<std::filesystem::path> folders;
  std::filesystem::path output;  ///< A folder; made if missing.
};

/// Puts movements, measures, findings, and pictures of bones and predicted faces beside each other:
/// `variants.html`, `variants.pdf`, `variants.csv` and `variants.json`. A prediction that did not
/// converge is left out, with a warning.
///
/// \returns the summary, or
///   - kInvalidArgument  fewer than two folders or more than four, two of the same name, or plans
///     of different heads;
///   - kFileNotFound     a folder has no check/check.json;
///   - kFileCorrupt      a document is not of its format;
///   - kFileUnsupported  a check is of another version;
///   - kFileUnwritable   a result cannot be written.
[[nodiscard]] Result<Summary> compare_variants(const VariantsJob& job, Progress& progress);

}  // namespace lefort::pipeline
