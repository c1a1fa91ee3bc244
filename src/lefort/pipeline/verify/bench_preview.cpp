#include <lefort/geometry/rigid_path.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/verify.h>
#include <lefort/predict/face_preview.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

namespace lefort::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Largest translation of a segment along its path [mm].
double length_mm(const std::vector<geometry::RigidPath>& paths) {
  double max_mm = 0.0;
  for (const geometry::RigidPath& path : paths)
    max_mm = std::max(max_mm, geometry::pose_at(path, 1.0).translation().norm());
  return max_mm;
}

/// Seconds of each update along the path, and the skin at its end.
struct Drag {
  std::vector<double> seconds = {};
  std::vector<Vec3> skin_mm = {};
};

Result<Drag> drag(const predict::FacePreview& face, const std::vector<geometry::RigidPath>& paths,
                  int frames, Progress& progress) {
  Drag dragged;
  for (int frame = 1; frame <= frames; ++frame) {
    const auto begin = Clock::now();
    LEFORT_TRY(dragged.skin_mm,
               face.displacement_mm(geometry::poses_at(paths, double(frame) / frames)));
    dragged.seconds.push_back(seconds_since(begin));
    progress.report(double(frame) / frames);
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "cancelled");
  }
  return dragged;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// \param skin_mm  displacement of the skin by the preview.
Result<void> add_distance_from(const std::filesystem::path& prediction,
                               const std::vector<Vec3>& skin_mm, Summary& summary) {
  LEFORT_TRY(const auto before_L, io::read_surface(prediction / "skin_before.vtp"));
  LEFORT_TRY(const auto after_L, io::read_surface(prediction / "predicted_skin.vtp"));
  if (before_L.vertices.size() != skin_mm.size() || after_L.vertices.size() != skin_mm.size())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: the prediction is of another skin", prediction.string()));
  const predict::PreviewDistance off =
      predict::measure_preview(skin_mm, before_L.vertices, after_L.vertices);
  summary.json["p50_mm"] = off.p50_mm;
  summary.json["p99_mm"] = off.p99_mm;
  summary.json["max_mm"] = off.max_mm;
  summary.text += fmt::format(
      "; from the prediction, where the skin moved: P50 {:.2f} mm, P99 {:.2f} mm, max {:.2f} mm",
      off.p50_mm, off.p99_mm, off.max_mm);
  return {};
}

}  // namespace

Result<Summary> bench_preview(const PreviewBenchJob& job, Progress& progress) {
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const StageCache cache(job.output / "cache");
  LEFORT_TRY(const io::PlanText text, read_plan_of_scan(job.plan, job.ct, cache, progress));
  io::note_warnings(text.plan.warnings, progress);
  LEFORT_TRY(const PreparedCase prepared,
             prepare_case(text.plan, io::Sha256().add(text.json).hex(), job.ct, cache, progress));
  const auto begin = Clock::now();
  LEFORT_TRY(const predict::FacePreview face,
             preview_face(prepared, prepared.skin_L, cache, progress));
  const double prepare_s = seconds_since(begin);
  const std::vector<geometry::RigidPath> paths = prepared.paths();
  const int frames = std::max(2, int(std::ceil(length_mm(paths) / job.frame_mm)));
  progress.begin_stage("drag along the path");
  LEFORT_TRY(const Drag dragged, drag(face, paths, frames, progress));
  const Index drag_iterations = face.newton_iterations();
  const std::vector<RigidTransform> rest(paths.size(), RigidTransform::Identity());
  LEFORT_TRY_VOID(face.displacement_mm(rest));
  progress.begin_stage("jump to the end of the path");
  const Index before = face.newton_iterations();
  const auto jump_begin = Clock::now();
  LEFORT_TRY(const std::vector<Vec3> jumped_mm,
             face.displacement_mm(geometry::poses_at(paths, 1.0)));
  const double jump_s = seconds_since(jump_begin);
  double path_mm = 0.0;  // Influence of the starting point.
  for (std::size_t v = 0; v < jumped_mm.size(); ++v)
    path_mm = std::max(path_mm, (jumped_mm[v] - dragged.skin_mm[v]).norm());
  Summary summary;
  summary.json = {{"elements", face.element_count()},
                  {"prepare_s", prepare_s},
                  {"frames", frames},
                  {"update_median_s", median(dragged.seconds)},
                  {"update_max_s", *std::ranges::max_element(dragged.seconds)},
                  {"iterations_per_update", double(drag_iterations) / frames},
                  {"jump_s", jump_s},
                  {"jump_iterations", face.newton_iterations() - before},
                  {"start_influence_mm", path_mm}};
  summary.text = fmt::format(
      "{} elements: prepared in {:.1f} s; {} updates of {:.2g} mm: median {:.3f} s, longest {:.3f} "
      "s, {:.1f} iterations each; from rest to the end of the path: {:.2f} s, {} iterations; the "
      "start changes the skin by at most {:.4f} mm",
      face.element_count(), prepare_s, frames, length_mm(paths) / frames, median(dragged.seconds),
      *std::ranges::max_element(dragged.seconds), double(drag_iterations) / frames, jump_s,
      face.newton_iterations() - before, path_mm);
  if (job.prediction) LEFORT_TRY_VOID(add_distance_from(*job.prediction, jumped_mm, summary));
  LEFORT_TRY_VOID(io::write_text(job.output / "preview_bench.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
