/// \file
/// What each kind of job does with the case's folder: by the functions of pipeline.h, as the
/// command line does it.
#pragma once

#include <lefort/server/case/case_folder.h>
#include <lefort/server/case/event_log.h>
#include <lefort/server/case/jobs.h>
#include <lefort/server/case/solve_history.h>
#include <lefort/server/case/uploads.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::server {

/// Where a job finds what it works on.
struct JobContext {
  CaseFolder& folder;
  Uploads& uploads;
  EventLog& events;
  SolveHistory& history;
  std::optional<std::filesystem::path> example;  ///< The scan that an import of it reads.
};

/// The kinds that run_job() knows.
[[nodiscard]] std::vector<std::string> job_kinds();

/// The kind of job that makes a stage; empty for what people make.
[[nodiscard]] std::string job_of_stage(std::string_view stage);

/// \param job  its parameters fit contract/openapi.json, JobRequest.
[[nodiscard]] Result<JobOutcome> run_job(const JobContext& context, const JobRecord& job,
                                         Progress& progress);

}  // namespace lefort::server
