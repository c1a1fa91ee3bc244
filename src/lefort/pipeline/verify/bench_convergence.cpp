#include <lefort/bench/convergence.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/verify.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// Copies of a plan, one for each number of steps.
Result<std::vector<bench::ConvergenceCase>> cases_of(const fs::path& plan_file,
                                                     const ConvergenceJob& job,
                                                     Progress& progress) {
  LEFORT_TRY(io::PlanText text, io::read_plan_text(plan_file));
  io::note_warnings(text.plan.warnings, progress);
  const std::optional<fs::path> ct = job.ct ? job.ct : text.plan.ct;
  std::error_code error;
  if (!ct || !fs::exists(*ct, error))
    return fail(ErrorCode::kFileNotFound,
                fmt::format("plan {} has no scan: set --ct", plan_file.string()));
  text.plan.contact.detection =
      contact::DetectionMethod::kSmooth;  // All methods can use its field.
  text.plan.contact.obstacle = predict::Obstacle::kBone;
  if (job.element_size_mm) {
    predict::TissueOptions& tissue = text.plan.tissue;
    tissue.far_element_size_mm *= *job.element_size_mm / tissue.element_size_mm;
    tissue.element_size_mm = *job.element_size_mm;
  }
  LEFORT_TRY(PreparedCase prepared,
             prepare_case(std::move(text.plan), io::Sha256().add(text.json).hex(), *ct,
                          StageCache(job.output / "cache"), progress));
  const io::PlanFile& plan = prepared.plan;
  const std::string name = plan_file.stem().string();
  bench::ConvergenceCase task{.name = name,
                              .mesh_name = name,
                              .model = std::move(prepared.model),
                              .paths = prepared.paths(),
                              .options = {plan.tissue, plan.boundary, plan.contact, plan.solver}};
  if (job.steps.empty()) return std::vector{std::move(task)};
  std::vector<bench::ConvergenceCase> cases;
  for (const int steps : job.steps) {
    task.name = fmt::format("{}-{}-steps", name, steps);
    for (geometry::RigidPath& path : task.paths) path.steps = steps;
    cases.push_back(task);
  }
  return cases;
}

Result<std::vector<bench::ContactMethod>> choose_methods(const std::vector<std::string>& names) {
  const std::vector<bench::ContactMethod> known = bench::contact_methods();
  if (names.empty()) return known;
  std::vector<bench::ContactMethod> chosen;
  for (const std::string& name : names) {
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const auto& method) { return method.name == name; });
    if (found == known.end())
      return fail(ErrorCode::kInvalidArgument, fmt::format("unknown method {}", name));
    chosen.push_back(*found);
  }
  return chosen;
}

}  // namespace

Result<Summary> bench_convergence(const ConvergenceJob& job, Progress& progress) {
  bench::ConvergenceOptions options{.output = job.output};
  LEFORT_TRY(options.methods, choose_methods(job.methods));
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  std::vector<bench::ConvergenceCase> cases;
  if (job.synthetic) {
    LEFORT_TRY(cases, bench::synthetic_cases(progress));
  }
  for (const fs::path& plan : job.plans) {
    LEFORT_TRY(const std::vector<bench::ConvergenceCase> prepared, cases_of(plan, job, progress));
    cases.insert(cases.end(), prepared.begin(), prepared.end());
  }
  LEFORT_TRY(const std::string table, bench::run_convergence(cases, options, progress));
  return Summary{.text = table, .json = {{"output", job.output.string()}}};
}

}  // namespace lefort::pipeline
