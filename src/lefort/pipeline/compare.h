/// \file
/// How far two faces are apart.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

struct CompareJob {
  std::filesystem::path face;                      ///< A surface, or the folder of a prediction.
  std::optional<std::filesystem::path> other;      ///< Likewise: what it is held against.
  std::optional<std::filesystem::path> after_ct;   ///< Instead: a scan after surgery.
  std::optional<std::filesystem::path> before;     ///< The skin before surgery, for the baseline.
  std::optional<std::filesystem::path> landmarks;  ///< Before surgery: they tell the regions.
  std::filesystem::path output;                    ///< A folder; made if missing.
  bool pictures = true;
};
/// Two faces -> how far they are apart, by region; with a scan after surgery also how each segment
/// was moved.
[[nodiscard]] Result<Summary> compare_faces(const CompareJob& job, Progress& progress);

}  // namespace lefort::pipeline
