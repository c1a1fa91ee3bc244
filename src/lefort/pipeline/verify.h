/// \file
/// Verification of the solver, and convergence of contact methods.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct ConvergenceJob {
  std::vector<std::filesystem::path> plans;
  std::optional<std::filesystem::path> ct;  ///< Instead of the plans'.
  std::filesystem::path output;             ///< A folder; made if missing.
  std::vector<std::string> methods;         ///< Names; empty: all.
  std::optional<double> element_size_mm;    ///< Instead of the plans'; scales far elements, too.
  std::vector<int> steps;  ///< Each plan with each number of steps; empty: its own.
  bool synthetic = true;   ///< Also the cases that need no scan.
};

/// Measures the convergence of the Newton residual with each detection method (Figure 5 of the
/// paper).
///
/// \returns the table, or
///   - kInvalidArgument  a method has another name than those of bench::contact_methods();
///   - kFileNotFound     a plan has no scan, or the scan does not exist;
///   - the errors of io::read_plan_text(), prepare_case() and predict::predict_face();
///   - kFileUnwritable   a result cannot be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<Summary> bench_convergence(const ConvergenceJob& job, Progress& progress);

struct LandmarkBenchJob {
  int heads = 10;                ///< Number of synthetic heads.
  std::uint64_t seed = 1;        ///< Of the first head; the others follow.
  double voxel_mm = 1.25;        ///< Of their scans.
  double noise_hu = 20.0;        ///< Standard deviation.
  std::filesystem::path output;  ///< A table, .csv: one line for each landmark of each head.
  std::optional<std::filesystem::path>
      scans;  ///< A folder for the scans; not written unless given.
};
/// Distances between found and true landmarks of heads of random shape
/// (anatomy/parametric_head.h).
///
/// \returns the table; kInvalidArgument if `output` does not end in .csv; the errors of
///   find_head_landmarks(); or kFileUnwritable.
[[nodiscard]] Result<Summary> bench_landmarks(const LandmarkBenchJob& job, Progress& progress);

struct DentalBenchJob {
  int heads = 2;                 ///< Number of synthetic heads with teeth.
  std::uint64_t seed = 101;      ///< Of the first head; the others follow.
  int starts = 3;                ///< Random frames of scans and positions of the lower arch.
  double voxel_mm = 0.6;         ///< Of the scans of the jaws.
  double noise_hu = 20.0;        ///< Standard deviation.
  std::filesystem::path output;  ///< A table, .csv: one line for each figure.
};
/// Errors of the dental functions on synthetic heads of random shape with teeth and canals
/// (anatomy/parametric_head.h), which chose no constant: numbers of teeth, canals, intraoral scans
/// in the CT, occlusion by search and from a bite scan after disturbances of up to 5 mm and 8
/// degrees, and the fit of a splint. Labels and landmarks are the true ones.
///
/// \returns the table with targets; kInvalidArgument if `output` does not end in .csv; the errors
///   of the scan (a function without a result counts as 99); or kFileUnwritable.
[[nodiscard]] Result<Summary> bench_dental(const DentalBenchJob& job, Progress& progress);

struct PreviewBenchJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path output;  ///< A folder, made if missing: preview_bench.json and the cache.
  std::optional<std::filesystem::path> prediction;  ///< Folder of a prediction of the same plan.
  double frame_mm = 1.0;  ///< Motion of the segments between two updates, > 0.
};
/// Measures the preview of the face: seconds of each update while the segments move along their
/// paths, of a jump from rest to the end, and the distance from the prediction.
///
/// \returns the figures; kInvalidArgument if the prediction is of another skin; kCancelled; or the
///   errors of io::read_plan_text(), prepare_case(), predict::FacePreview, io::read_surface() and
///   io::write_text().
[[nodiscard]] Result<Summary> bench_preview(const PreviewBenchJob& job, Progress& progress);

struct BenchAllJob {
  std::filesystem::path ct;
  std::filesystem::path output;                  ///< A folder; made if missing.
  std::optional<std::filesystem::path> plan;     ///< Also its prediction and preview.
  std::optional<std::filesystem::path> against;  ///< bench.json of an earlier run.
  double threshold = 0.15;  ///< Allowed loss of a ratio, as a fraction of the stored one.
  int repeats = 3;          ///< Builds of fields and runs of CalculiX; medians are reported.
  std::vector<int> resolutions = {128, 256, 512};  ///< Of the fields.
  int comparison_cells = 16;  ///< Per side of the block that CalculiX solves, too.
};

struct BenchSummary {
  Summary summary;
  bool passed = true;  ///< No ratio is lower than stored by more than the threshold.
};

/// Runs the benchmarks of fields, contact detection and the solver with their peers, and of a
/// plan's prediction and preview. Writes each one's files, and bench.md, .json and a plot of all.
///
/// \returns the summary; kFileCorrupt if `against` is not such a file; kInvalidArgument if it is of
///   another scan or would be overwritten; kCancelled; or the errors of io::read_plan_text(),
///   the benchmarks, predict_case() and bench_preview().
[[nodiscard]] Result<BenchSummary> bench_all(const BenchAllJob& job, Progress& progress);

struct VerifyJob {
  std::filesystem::path output;  ///< A folder, made if missing; empty: no report.
  bool full = false;             ///< All meshes of the report; otherwise those of the test.
  std::string only;              ///< Name of one case; empty for all.
};

struct VerifySummary {
  Summary summary;
  bool passed = false;  ///< Every check, except known failures.
};

/// Runs the verification suite of the solver, and writes verification.md and its plots.
///
/// \returns the summary, whether or not checks failed; or
///   - kInvalidArgument  there is no case named `only`;
///   - kFileUnwritable   the folder contains a full report and this run is not full or has `only`,
///     or a file cannot be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<VerifySummary> verify_solver(const VerifyJob& job, Progress& progress);

}  // namespace lefort::pipeline
