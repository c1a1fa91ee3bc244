/// \file
/// Jobs of teeth and measures: numbered teeth, intraoral scans, occlusion, splints, canals, cutting
/// guides, airway, cephalogram. measure_routes() serves the document of each result, so that jobs
/// return none.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/server/case/case_jobs.h>
#include <lefort/server/case/jobs.h>

#include <string>

namespace lefort::server {

/// The stage of a job `splint`: "splint_final" or "splint_intermediate".
[[nodiscard]] std::string stage_of_splint(const JobRecord& job);

[[nodiscard]] Result<JobOutcome> teeth_job(const JobContext&, const JobRecord&, Progress&);
[[nodiscard]] Result<JobOutcome> arches_job(const JobContext&, const JobRecord&, Progress&);
[[nodiscard]] Result<JobOutcome> occlusion_job(const JobContext&, const JobRecord&, Progress&);
[[nodiscard]] Result<JobOutcome> splint_job(const JobContext&, const JobRecord&, Progress&);
[[nodiscard]] Result<JobOutcome> nerve_job(const JobContext&, const JobRecord&, Progress&);
[[nodiscard]] Result<JobOutcome> guides_job(const JobContext&, const JobRecord&, Progress&);
[[nodiscard]] Result<JobOutcome> airway_job(const JobContext&, const JobRecord&, Progress&);
[[nodiscard]] Result<JobOutcome> cephalogram_job(const JobContext&, const JobRecord&, Progress&);

}  // namespace lefort::server
