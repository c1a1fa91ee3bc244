#include <lefort/bench/contact_bench.h>
#include <lefort/bench/detection.h>
#include <lefort/bench/figures.h>
#include <lefort/bench/solve_block.h>
#include <lefort/bench/table1.h>
#include <lefort/core/parallel.h>
#include <lefort/core/version.h>
#include <lefort/field/simd.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/predict.h>
#include <lefort/pipeline/verify.h>
#include <lefort/report/plot_lines.h>

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using bench::Figure;

constexpr std::uintmax_t kMaxFigureBytes = 1 << 26;
constexpr const char* kFile = "bench.json";

/// Instruction set of the kernels, which changes ratios.
const char* simd_name() {
  switch (field::best_simd()) {
    case field::Simd::kAvx512:
      return "AVX-512";
    case field::Simd::kAvx2:
      return "AVX2";
    default:
      return "baseline";
  }
}

Result<Json> read_figures(const fs::path& file) {
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxFigureBytes));
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded())
    return fail(ErrorCode::kFileCorrupt, fmt::format("{}: not JSON", file.string()));
  return json;
}

/// Ratios of an earlier run; null without one.
/// \param scan  SHA-256 of the scan of this run.
Result<Json> read_stored(const BenchAllJob& job, const std::string& scan) {
  if (!job.against) return Json();
  std::error_code ignored;
  if (fs::equivalent(*job.against, job.output / kFile, ignored))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} would be overwritten; choose another output folder",
                            job.against->string()));
  LEFORT_TRY(Json stored, read_figures(*job.against));
  if (!stored.is_object() || !stored.contains("figures") || !stored.at("figures").is_object())
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{}: has no \"figures\"; give a bench.json of `lefort bench all`",
                            job.against->string()));
  if (!scan.empty() && stored.value("scan", scan) != scan)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: is of another scan", job.against->string()));
  if (stored.value("simd", simd_name()) != simd_name())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: is of a processor with {}, this one has {}; store ratios of this "
                            "machine",
                            job.against->string(), stored.value("simd", ""), simd_name()));
  return stored;
}

void append(std::vector<Figure> more, std::vector<Figure>& figures) {
  figures.insert(figures.end(), more.begin(), more.end());
}

Result<std::vector<Figure>> measure_parts(const BenchAllJob& job, Progress& progress) {
  std::vector<Figure> figures;
  const fs::path fields = job.output / "fields", solve = job.output / "solve";
  std::error_code ignored;
  fs::remove(fields / "skull.vtp", ignored);  // It may be of another scan.
  LEFORT_TRY(const std::string table1, bench::run_table1({.ct = job.ct,
                                                          .output = fields,
                                                          .resolutions = job.resolutions,
                                                          .methods = {"bricks", "openvdb"},
                                                          .repeats = job.repeats},
                                                         progress));
  LEFORT_TRY(const Json fields_json, read_figures(fields / "table1.json"));
  append(bench::figures_of_table1(fields_json), figures);
  LEFORT_TRY(const std::string detection,
             bench::run_detection({.ct = job.ct, .output = fields}, progress));
  LEFORT_TRY(const Json detection_json, read_figures(fields / "detection.json"));
  append(bench::figures_of_detection(detection_json), figures);
  LEFORT_TRY(
      const std::string blocks,
      bench::run_solve_bench(
          {.output = solve, .repeats = job.repeats, .pair_cells = job.comparison_cells}, progress));
  LEFORT_TRY(const Json solve_json, read_figures(solve / "solve.json"));
  append(bench::figures_of_solve(solve_json), figures);
  const fs::path contact = job.output / "contact";
  LEFORT_TRY(const std::string ball,
             bench::run_contact_bench(
                 {.output = contact, .threads = ThreadLimit::current(), .repeats = job.repeats},
                 progress));
  LEFORT_TRY(const Json contact_json, read_figures(contact / "contact.json"));
  append(bench::figures_of_contact(contact_json), figures);
  return figures;
}

/// The prediction of a plan from the scan to the report, and its preview.
Result<std::vector<Figure>> measure_plan(const BenchAllJob& job, Progress& progress) {
  constexpr double kFrame_mm = 0.25;  // Of a slow drag; larger ones are solved to equilibrium.
  const fs::path prediction = job.output / "prediction";
  std::error_code ignored;
  fs::remove_all(prediction / "cache", ignored);  // Cached stages would take no time.
  LEFORT_TRY(
      const Summary predicted,
      predict_case({.plan = *job.plan, .ct = job.ct, .output = prediction, .sensitivity = false},
                   progress));
  LEFORT_TRY(const Json document, read_figures(prediction / "prediction.json"));
  const Json& timing = document.at("timing");
  std::vector<Figure> figures{
      {.name = "prediction, scan to report", .value = timing.at("total_seconds"), .unit = "s"},
      {.name = "prediction, solve", .value = timing.at("stage_seconds").at("solve"), .unit = "s"},
      {.name = "prediction, memory", .value = timing.at("peak_memory_mb"), .unit = "MB"}};
  LEFORT_TRY(const Summary preview, bench_preview({.plan = *job.plan,
                                                   .ct = job.ct,
                                                   .output = job.output / "preview",
                                                   .prediction = prediction,
                                                   .frame_mm = kFrame_mm},
                                                  progress));
  figures.push_back({"preview, update of 0.25 mm", preview.json.at("update_median_s"), "s"});
  figures.push_back({"preview, after the release", preview.json.at("release_s"), "s"});
  figures.push_back({"preview, rest to end", preview.json.at("jump_s"), "s"});
  figures.push_back({"preview, P99 from the prediction", preview.json.at("p99_mm"), "mm"});
  return figures;
}

/// All ratios in one plot, in the order of the table.
std::string plot_of(std::span<const Figure> figures, const Json& stored) {
  report::PlotLine now{.name = "measured"}, before{.name = "stored"};
  const Json none = Json::object();
  const Json& kept = stored.is_object() ? stored.at("figures") : none;
  const Json ratios = bench::to_json(figures).at("figures");
  double row = 0.0;
  for (const auto& [name, ratio] : ratios.items()) {
    row += 1.0;
    now.x.push_back(row);
    now.y.push_back(ratio.get<double>());
    if (!kept.contains(name) || !kept.at(name).is_number()) continue;
    before.x.push_back(row);
    before.y.push_back(kept.at(name).get<double>());
  }
  report::LinePlot plot{.title = "Ratios to peers",
                        .x_label = "ratio, in the order of the table",
                        .y_label = "times as fast as its peer",
                        .y_axis = report::Axis::kLog,
                        .lines = {now}};
  if (!before.x.empty()) plot.lines.push_back(before);
  return report::plot_file(plot);
}

std::string page_of(std::span<const Figure> figures, const Json& stored,
                    std::span<const std::string> regressions, const BenchAllJob& job) {
  std::string text = fmt::format(
      "# Benchmarks\n\nlefort {}, `lefort bench all`. {} A ratio is how many times as fast as its "
      "peer lefort is, one after the other on this machine. Builds of fields and runs of "
      "CalculiX: medians of {}; queries: the best of several; growth, prediction and preview: one "
      "run.\n\n{}\n![Ratios to peers](bench.svg)\n\n",
      kVersion, kNotForClinicalUse, job.repeats, bench::figure_table(figures, stored));
  if (job.against)
    text += regressions.empty()
                ? fmt::format("No ratio is more than {:.0f} % below the stored one.\n",
                              100.0 * job.threshold)
                : "Below the stored ratios, or missing:\n\n";
  for (const std::string& sentence : regressions) text += "- " + sentence + "\n";
  return text;
}

}  // namespace

Result<BenchSummary> bench_all(const BenchAllJob& job, Progress& progress) {
  if (job.plan) LEFORT_TRY_VOID(io::read_plan_text(*job.plan));  // Errors now, not after an hour.
  std::string scan;                                              // Empty for a folder.
  if (!fs::is_directory(job.ct)) {
    LEFORT_TRY(scan, io::sha256_of_file(job.ct));
  }
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY(const Json stored, read_stored(job, scan));
  const auto write_figures = [&](std::span<const Figure> figures) {
    Json document = bench::to_json(figures);
    document["scan"] = scan;
    document["simd"] = simd_name();
    return io::write_text(job.output / kFile, document.dump(1) + "\n");
  };
  LEFORT_TRY(std::vector<Figure> figures, measure_parts(job, progress));
  LEFORT_TRY_VOID(write_figures(figures));
  if (job.plan) {
    LEFORT_TRY(std::vector<Figure> of_plan, measure_plan(job, progress));
    append(std::move(of_plan), figures);
  }
  const std::vector<std::string> regressions =
      bench::find_regressions(figures, stored, job.threshold);
  const std::string page = page_of(figures, stored, regressions, job);
  LEFORT_TRY_VOID(write_figures(figures));
  LEFORT_TRY_VOID(io::write_text(job.output / "bench.svg", plot_of(figures, stored)));
  LEFORT_TRY_VOID(io::write_text(job.output / "bench.md", page));
  return BenchSummary{.summary = {.text = page,
                                  .json = {{"output", job.output.string()},
                                           {"regressions", regressions},
                                           {"figures", bench::to_json(figures).at("figures")}}},
                      .passed = regressions.empty()};
}

}  // namespace lefort::pipeline
