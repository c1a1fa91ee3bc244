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

/// Seconds of each update along the path, and the skin after it.
struct Drag {
  std::vector<double> seconds = {};
  std::vector<std::vector<Vec3>> skin_mm = {};
};

/// \param update  face at poses.
template <class Update>
Result<Drag> drag(const Update& update, const std::vector<geometry::RigidPath>& paths, int frames,
                  Progress& progress) {
  Drag dragged;
  for (int frame = 1; frame <= frames; ++frame) {
    const auto begin = Clock::now();
    LEFORT_TRY(std::vector<Vec3> skin_mm,
               update(geometry::poses_at(paths, double(frame) / frames)));
    dragged.seconds.push_back(seconds_since(begin));
    dragged.skin_mm.push_back(std::move(skin_mm));
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

/// Largest distance of a vertex [mm].
double farthest_mm(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double max_mm = 0.0;
  for (std::size_t v = 0; v < a.size(); ++v) max_mm = std::max(max_mm, (a[v] - b[v]).norm());
  return max_mm;
}

/// Updates in equilibrium, a jump to the end, and a drag with its release.
struct Updates {
  Drag in_equilibrium, followed;
  double iterations = 0.0;  ///< Of an update in equilibrium, mean.
  double jump_s = 0.0, release_s = 0.0;
  Index jump_iterations = 0;
  std::vector<Vec3> jumped_mm, released_mm;

  /// Largest distance of a followed face from the equilibrium of its poses [mm].
  [[nodiscard]] double lag_mm() const {
    double max_mm = 0.0;
    for (std::size_t n = 0; n < followed.skin_mm.size(); ++n)
      max_mm = std::max(max_mm, farthest_mm(followed.skin_mm[n], in_equilibrium.skin_mm[n]));
    return max_mm;
  }
  /// Influence of the starting point on the face at the end [mm].
  [[nodiscard]] double start_influence_mm() const {
    return std::max(farthest_mm(jumped_mm, in_equilibrium.skin_mm.back()),
                    farthest_mm(jumped_mm, released_mm));
  }
};

Result<Updates> measure_updates(const predict::FacePreview& face,
                                const std::vector<geometry::RigidPath>& paths, int frames,
                                Progress& progress) {
  const std::vector<RigidTransform> rest(paths.size(), RigidTransform::Identity());
  const std::vector<RigidTransform> end = geometry::poses_at(paths, 1.0);
  Updates updates;
  progress.begin_stage("equilibria along the path");
  const auto equilibrium = [&](const std::vector<RigidTransform>& X_LB) {
    return face.displacement_mm(X_LB);
  };
  LEFORT_TRY(updates.in_equilibrium, drag(equilibrium, paths, frames, progress));
  updates.iterations = double(face.newton_iterations()) / frames;
  LEFORT_TRY_VOID(face.displacement_mm(rest));
  progress.begin_stage("jump to the end of the path");
  const Index before = face.newton_iterations();
  const auto jump = Clock::now();
  LEFORT_TRY(updates.jumped_mm, face.displacement_mm(end));
  updates.jump_s = seconds_since(jump);
  updates.jump_iterations = face.newton_iterations() - before;
  LEFORT_TRY_VOID(face.displacement_mm(rest));
  progress.begin_stage("drag along the path");
  const auto follow = [&](const std::vector<RigidTransform>& X_LB) { return face.follow_mm(X_LB); };
  LEFORT_TRY(updates.followed, drag(follow, paths, frames, progress));
  const auto release = Clock::now();
  LEFORT_TRY(updates.released_mm, face.displacement_mm(end));
  updates.release_s = seconds_since(release);
  return updates;
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
  LEFORT_TRY(const Updates measured, measure_updates(face, paths, frames, progress));
  const std::vector<double>&equilibria = measured.in_equilibrium.seconds,
        &followed = measured.followed.seconds;
  Summary summary;
  summary.json = {{"elements", face.element_count()},
                  {"prepare_s", prepare_s},
                  {"frames", frames},
                  {"update_median_s", median(followed)},
                  {"update_max_s", *std::ranges::max_element(followed)},
                  {"lag_mm", measured.lag_mm()},
                  {"release_s", measured.release_s},
                  {"equilibrium_median_s", median(equilibria)},
                  {"equilibrium_max_s", *std::ranges::max_element(equilibria)},
                  {"iterations_per_equilibrium", measured.iterations},
                  {"jump_s", measured.jump_s},
                  {"jump_iterations", measured.jump_iterations},
                  {"start_influence_mm", measured.start_influence_mm()}};
  summary.text = fmt::format(
      "{} elements: prepared in {:.1f} s; drag, {} updates of {:.2g} mm: median {:.3f} s, longest "
      "{:.3f} s, at most {:.2f} mm from the equilibrium, which is found {:.2f} s after the "
      "release; "
      "updates in equilibrium: median {:.3f} s, {:.1f} iterations; from rest to the end of the "
      "path: {:.2f} s, {} iterations; the start changes the skin by at most {:.4f} mm",
      face.element_count(), prepare_s, frames, length_mm(paths) / frames, median(followed),
      *std::ranges::max_element(followed), measured.lag_mm(), measured.release_s,
      median(equilibria), measured.iterations, measured.jump_s, measured.jump_iterations,
      measured.start_influence_mm());
  if (job.prediction) {
    LEFORT_TRY_VOID(add_distance_from(*job.prediction, measured.released_mm, summary));
  }
  LEFORT_TRY_VOID(io::write_text(job.output / "preview_bench.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
