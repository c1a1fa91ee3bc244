#include <lefort/core/types.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/verify.h>
#include <lefort/verify/run_suite.h>
#include <lefort/verify/verification_report.h>

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

namespace lefort::pipeline {
namespace {

nlohmann::json json_of(const verify::Check& check) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
  };
  const char* const required = check.comparison == verify::Comparison::kNear      ? "near"
                               : check.comparison == verify::Comparison::kAtLeast ? "at least"
                                                                                  : "at most";
  return {{"name", check.name},
          {"measured", number(check.measured)},
          {"required", required},
          {"expected", check.expected},
          {"tolerance", check.tolerance},
          {"unit", check.unit},
          {"reason", check.reason},
          {"note", check.note},
          {"known_failure", check.known_failure},
          {"passed", check.passed()}};
}

std::string command_of(const VerifyJob& job) {
  return fmt::format("lefort verify{}{}", job.full ? " --full" : "",
                     job.only.empty() ? "" : " --only " + job.only);
}

constexpr const char* kReport = "verification.md";

/// Checks that a part of the suite, or its short form, does not overwrite a full report.
Result<void> check_full_report_is_kept(const VerifyJob& job) {
  constexpr std::uintmax_t kMaxReport = 100'000'000;
  if (job.full && job.only.empty()) return {};
  const Result<std::string> there = io::read_text(job.output / kReport, kMaxReport);
  constexpr const char* kWhole = "`lefort verify --full`";  // As command_of() returns it.
  if (!there || there->find(kWhole) == std::string::npos) return {};
  return fail(ErrorCode::kFileUnwritable,
              fmt::format("{} is a full report, made by {}; choose another "
                          "output folder",
                          (job.output / kReport).string(), kWhole));
}

}  // namespace

Result<VerifySummary> verify_solver(const VerifyJob& job, Progress& progress) {
  if (!job.output.empty()) {
    LEFORT_TRY_VOID(check_full_report_is_kept(job));
    LEFORT_TRY_VOID(io::make_output_folder(job.output));
  }
  const verify::SuiteOptions options{
      .extent = job.full ? verify::Extent::kFull : verify::Extent::kShort, .only = job.only};
  LEFORT_TRY(const auto sections, verify::run_suite(options, progress));
  if (!job.output.empty())
    for (const verify::ReportFile& file : verify::verification_report(sections, command_of(job)))
      LEFORT_TRY_VOID(io::write_text(job.output / file.name, file.content));

  VerifySummary done;
  Index count = 0;
  Index failed = 0;
  Index missed = 0;
  std::string failures;
  for (const verify::Section& section : sections) {
    nlohmann::json checks = nlohmann::json::array();
    for (const verify::Check& check : section.checks) {
      ++count;
      checks.push_back(json_of(check));
      if (check.passed()) continue;
      if (check.is_acceptable()) {
        ++missed;
        continue;
      }
      ++failed;
      failures +=
          fmt::format("\nfailed: {}: {}: {}", section.name, check.name, verify::text_of(check));
    }
    done.summary.json["cases"].push_back(
        {{"name", section.name}, {"passed", section.passed()}, {"checks", checks}});
  }
  done.passed = failed == 0;
  done.summary.json["passed"] = done.passed;
  done.summary.text = fmt::format("{} of {} checks passed, {} missed as known{}",
                                  count - failed - missed, count, missed, failures);
  return done;
}

}  // namespace lefort::pipeline
