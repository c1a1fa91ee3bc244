/// \file
/// The work of each kind of job in the case's folder, by the functions of the layer pipeline.
#pragma once

#include <lefort/pipeline/preview.h>
#include <lefort/server/case/case_folder.h>
#include <lefort/server/case/event_log.h>
#include <lefort/server/case/jobs.h>
#include <lefort/server/case/lru_cache.h>
#include <lefort/server/case/solve_history.h>
#include <lefort/server/case/uploads.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::server {

/// Inputs of all jobs.
struct JobContext {
  CaseFolder& folder;
  Uploads& uploads;
  EventLog& events;
  SolveHistory& history;
  LruCache<predict::FacePreview>& previews;      ///< Receives the model of the job preview-factor.
  std::optional<std::filesystem::path> example;  ///< Scan of the bundled example.
};

/// A message without the path of the case folder.
[[nodiscard]] std::string without_paths(std::string text, const CaseFolder& folder);

/// Inputs of the preview of a case.
[[nodiscard]] pipeline::PreviewJob preview_inputs(const CaseFolder& folder);

/// The kinds of run_job().
[[nodiscard]] std::vector<std::string> job_kinds();

/// The stage that a job computes; empty for an unknown kind.
[[nodiscard]] std::string stage_of(const JobRecord& job);

/// \param job  whose parameters match contract/openapi.json, JobRequest.
[[nodiscard]] Result<JobOutcome> run_job(const JobContext& context, const JobRecord& job,
                                         Progress& progress);

}  // namespace lefort::server
