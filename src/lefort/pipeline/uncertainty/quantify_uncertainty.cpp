#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cohort/memory_limit.h>
#include <lefort/pipeline/uncertainty.h>
#include <lefort/pipeline/uncertainty/inputs_json.h>
#include <lefort/pipeline/uncertainty/uncertainty_results.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/report/report_html.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

std::string text_of_results(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Result<void> check_job(const UncertaintyJob& job) {
  const auto wrong = [](const char* option, int value, const char* range) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is {}, must be {}", option, value, range));
  };
  constexpr int kFewest = 20, kMost = 20000;
  if (job.samples < kFewest || job.samples > kMost)
    return wrong("--samples", job.samples, "from 20 to 20000");
  if (job.fine_samples != 0 && (job.fine_samples < 3 || job.fine_samples > job.samples))
    return wrong("--fine", job.fine_samples, "0, or from 3 to the number of samples");
  if (job.path_checks < 0 || job.path_checks > job.samples)
    return wrong("--path-checks", job.path_checks, "from 0 to the number of samples");
  if (job.chunk && (job.chunk->count < 1 || job.chunk->count > job.samples ||
                    job.chunk->number < 1 || job.chunk->number > job.chunk->count))
    return wrong("--chunk", job.chunk->number, "from 1 to the number of chunks, at most --samples");
  return {};
}

/// Results of an earlier run, uncertainty.json first: it shows that the others are complete.
Result<void> remove_earlier_results(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const char* name :
       {"uncertainty.json", "samples.csv", "uncertainty.vtp", "inputs.json", "report.html",
        "pictures/band_front.png", "pictures/band_right.png", "pictures/band_left.png",
        "pictures/profile.svg", "pictures/sobol.svg", "pictures/convergence.svg"})
    files.push_back(folder / name);
  return io::remove_earlier_files(files);
}

/// Differences of the samples that were solved both ways.
std::optional<PathCheck> check_paths(const UncertainCase& face, const SolvedSamples& coarse,
                                     const SolvedSamples& paths) {
  PathCheck check;
  double sum = 0.0, area = 0.0;
  const SampledSkin& skin = face.skin();
  for (std::size_t k = 0; k < paths.numbers.size(); ++k) {
    const SampleResult& whole = paths.results[k];
    const auto at =
        std::lower_bound(coarse.numbers.begin(), coarse.numbers.end(), paths.numbers[k]);
    const SampleResult& warm = coarse.results[std::size_t(at - coarse.numbers.begin())];
    if (!whole.is_solved() || !warm.is_solved()) continue;
    ++check.samples;
    for (std::size_t v = 0; v < whole.normal_mm.size(); ++v) {
      if (skin.is_moved[v] == 0) continue;
      const double difference = std::abs(double(whole.normal_mm[v]) - double(warm.normal_mm[v]));
      sum += skin.area_mm2[v] * difference;
      area += skin.area_mm2[v];
      check.max_mm = std::max(check.max_mm, difference);
    }
  }
  if (check.samples == 0) return std::nullopt;
  check.mean_mm = area > 0.0 ? sum / area : 0.0;
  return check;
}

/// The median face with offsets of the quantiles along the normal.
Result<void> write_band(const fs::path& file, const UncertainCase& face,
                        const FaceStatistics& statistics) {
  const geometry::TriangleMesh median_L =
      predict::displaced(face.skin().skin_L, median_skin_mm(face, statistics));
  std::vector<double> low(face.skin().vertices.size()), high(low.size()), width(low.size());
  for (std::size_t k = 0; k < low.size(); ++k) {
    low[k] = statistics.band.quantiles[0][k] - statistics.band.quantiles[1][k];
    high[k] = statistics.band.quantiles[2][k] - statistics.band.quantiles[1][k];
    width[k] = high[k] - low[k];
  }
  return io::write_surface(
      file, median_L,
      {{"p5_mm", on_skin(face, low, 0.0)},
       {"p50_mm", std::vector<double>(median_L.vertices.size(), 0.0)},
       {"p95_mm", on_skin(face, high, 0.0)},
       {"band_width_mm", on_skin(face, width, 0.0)},
       {"standard_deviation_mm", on_skin(face, statistics.band.standard_deviation, 0.0)},
       {"normal", face.skin().normals_L}});
}

Result<void> write_all(const UncertaintyJob& job, const UncertainCase& face,
                       const UncertaintyResults& results,
                       const std::vector<UncertaintyPicture>& pictures,
                       const nlohmann::ordered_json& json, Progress& progress) {
  progress.begin_stage("write");
  const fs::path& folder = job.output;
  const report::CaseReport report = uncertainty_report(face, results, pictures);
  if (!pictures.empty()) {
    LEFORT_TRY_VOID(io::make_output_folder(folder / "pictures"));
    for (const UncertaintyPicture& picture : pictures)
      LEFORT_TRY_VOID(io::write_text(folder / "pictures" / picture.file, picture.png));
  }
  LEFORT_TRY_VOID(write_band(folder / "uncertainty.vtp", face, results.statistics));
  LEFORT_TRY_VOID(io::write_text(folder / "samples.csv", samples_csv(face, results)));
  LEFORT_TRY_VOID(
      io::write_text(folder / "inputs.json", text_of_results(pipeline::as_json(face.entries()))));
  LEFORT_TRY_VOID(io::write_text(folder / "report.html", report::report_html(report)));
  return io::write_text(folder / "uncertainty.json", text_of_results(json));
}

std::string in_words(const UncertaintyResults& results, const fs::path& folder) {
  const RegionStatistics& moved = results.statistics.region_results.front();
  std::string text = fmt::format(
      "{}: P5 to P95 of the moved skin {:.2f} mm on average, {:.2f} mm at most; Q2 "
      "{:.3f}; {} of {} samples failed",
      folder.string(), moved.band_mm, moved.max_band_mm, moved.q2, results.failed(),
      results.coarse.results.size());
  if (results.is_biased()) text += "; more than 5 %: the band is biased";
  return text;
}

}  // namespace

Result<Summary> quantify_uncertainty(const UncertaintyJob& job, Progress& progress) {
  LEFORT_TRY_VOID(check_job(job));
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  if (!job.chunk) LEFORT_TRY_VOID(remove_earlier_results(job.output));
  LEFORT_TRY(const std::unique_ptr<UncertainCase> face, UncertainCase::open(job, progress));
  // Before hours of solves. A chunk has no statistics.
  if (!job.chunk)
    LEFORT_TRY_VOID(check_statistics_memory(std::size_t(job.samples), face->skin().vertices.size(),
                                            machine_memory_gb()));
  UncertaintyResults results{
      .coarse = {}, .fine = {}, .statistics = {}, .path_check = {}, .models = 0, .seed = job.seed};
  LEFORT_TRY(results.coarse, face->solve_coarse(progress));
  LEFORT_TRY(results.fine, face->solve_fine(progress));
  if (job.chunk)
    return Summary{fmt::format("{}: chunk {} of {}, {} samples solved or found",
                               job.output.string(), job.chunk->number, job.chunk->count,
                               results.coarse.results.size() + results.fine.results.size()),
                   {{"chunk", job.chunk->number},
                    {"chunks", job.chunk->count},
                    {"samples", results.coarse.results.size()},
                    {"fine_samples", results.fine.results.size()},
                    {"failed", results.failed()}}};
  LEFORT_TRY(const SolvedSamples paths, face->solve_paths(progress));
  results.path_check = check_paths(*face, results.coarse, paths);
  results.models = face->model_count();
  LEFORT_TRY(results.statistics, face_statistics(*face, skin_regions(*face, progress),
                                                 results.coarse, results.fine, job.seed, progress));
  LEFORT_TRY_VOID(face->check_unchanged());
  if (job.fine_samples > 0 && !results.statistics.correction_results)
    progress.note(fmt::format(
        "warning: no correction by the mesh of the plan: fewer than 3 of its {} samples have a "
        "result; only samples at the middle level of all inputs in levels are used",
        results.fine.results.size()));
  std::vector<UncertaintyPicture> pictures;
  if (job.pictures) {
    LEFORT_TRY(pictures, draw_uncertainty(*face, results.statistics, progress));
  }
  if (results.is_biased())
    progress.note(fmt::format("warning: {} of {} samples have no result, more than {:g} %",
                              results.failed(), results.coarse.results.size(),
                              100.0 * kMaxFailedFraction));
  const nlohmann::ordered_json json = uncertainty_json(*face, results);
  LEFORT_TRY_VOID(write_all(job, *face, results, pictures, json, progress));
  return Summary{in_words(results, job.output), json};
}

Result<Summary> default_uncertain_inputs(const fs::path& plan) {
  LEFORT_TRY(const std::optional<io::OpenPlan> open, io::read_open_plan(plan));
  io::PlanFile read;
  if (open) {
    read = open->plan;
  } else {
    LEFORT_TRY(read, io::read_plan(plan));
  }
  const nlohmann::ordered_json json = pipeline::as_json(default_inputs(read));
  std::string text = text_of_results(json);
  text.pop_back();
  return Summary{std::move(text), json};
}

}  // namespace lefort::pipeline
