#include <lefort/io/output_folder.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/validate.h>
#include <lefort/pipeline/validate/cohort_folder.h>
#include <lefort/pipeline/validate/cohort_report.h>
#include <lefort/pipeline/validate/run_case.h>
#include <lefort/report/report_html.h>

#include <fmt/format.h>

#include <array>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kValidation = "validation.json";
constexpr const char* kValidationTable = "validation.csv";
constexpr const char* kValidationPage = "report.html";

/// The first two pictures of each case: from the front and from the right.
Result<std::vector<report::ReportPicture>> read_pictures(const fs::path& folder,
                                                         const std::vector<CaseResult>& cases) {
  constexpr std::uintmax_t kMaxBytes = 64 << 20;
  constexpr std::size_t kShown = 2;
  std::vector<report::ReportPicture> pictures;
  for (const CaseResult& one : cases)
    for (std::size_t p = 0; p < std::min(one.pictures.size(), kShown); ++p) {
      LEFORT_TRY(std::string png, io::read_text(folder / "pictures" / one.pictures[p], kMaxBytes));
      pictures.push_back(
          {one.name, "Predicted skin: difference to the achieved skin.", std::move(png)});
    }
  return pictures;
}

/// The page is written last: it shows that the other files are complete.
Result<Summary> write_reports(const ValidateJob& job, const CohortResults& results) {
  const auto json = cohort_json(results, job);
  LEFORT_TRY(std::vector<report::ReportPicture> pictures, read_pictures(job.output, results.cases));
  LEFORT_TRY_VOID(io::write_text(job.output / kValidationTable, cohort_csv(results)));
  LEFORT_TRY_VOID(io::write_text(job.output / kValidation, json.dump(2) + "\n"));
  LEFORT_TRY_VOID(io::write_text(job.output / kValidationPage,
                                 report::report_html(cohort_report(results, std::move(pictures)))));
  return Summary{job.output.string() + ": " + cohort_text(results), json};
}

}  // namespace

Result<Summary> validate_cohort(const ValidateJob& job, Progress& progress) {
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY(const std::vector<fs::path> folders,
             open_cohort(job.cohort, job.output,
                         std::array{kValidationPage, kValidation, kValidationTable}));
  CohortResults results;
  for (std::size_t k = 0; k < folders.size(); ++k) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled,
                  fmt::format("stopped after {} of {} cases; the same command "
                              "resumes",
                              k, folders.size()));
    CaseProgress of_case(
        fmt::format("case {} of {}, {}: ", k + 1, folders.size(), folders[k].filename().string()),
        progress);
    const CaseJob one{.folder = folders[k],
                      .cohort = job.cohort,
                      .output = job.output,
                      .setup = {job.achieved_movements, job.element_size_mm, job.voxel_mm},
                      .pictures = job.pictures};
    LEFORT_TRY(results.cases.emplace_back(), run_case(one, of_case));
    if (results.cases.back().failure)
      of_case.note(fmt::format("failed: {}", *results.cases.back().failure));
  }
  progress.begin_stage("write the report");
  results.regions = cohort_statistics(results.cases, results.bootstrap);
  return write_reports(job, results);
}

}  // namespace lefort::pipeline
