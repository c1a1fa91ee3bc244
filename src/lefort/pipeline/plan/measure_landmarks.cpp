#include <lefort/io/landmarks_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/plan/cephalometric_table.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/load_head.h>

#include <fmt/format.h>

namespace lefort::pipeline {
namespace {

nlohmann::json xyz_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json search_json(const plan::LandmarkSearch& search) {
  nlohmann::json found = nlohmann::json::object(), missing = nlohmann::json::object();
  for (const plan::FoundLandmark& one : search.found)
    found[one.landmark.name] = {{"point_mm", xyz_json(one.landmark.point_L)},
                                {"uncertainty_mm", one.uncertainty_mm}};
  for (const plan::MissingLandmark& one : search.missing) missing[one.name] = one.reason;
  const Mat3 R_LF = search.X_FL.linear().transpose();
  return {{"found", found},
          {"missing", missing},
          {"mid_sagittal_plane",
           {{"point_mm", xyz_json(search.mid_sagittal_L.point)},
            {"normal_to_left", xyz_json(search.mid_sagittal_L.normal)},
            {"rms_mm", search.mid_sagittal_L.rms_mm}}},
          {"directions",
           {{"left", xyz_json(R_LF.col(0))},
            {"posterior", xyz_json(R_LF.col(1))},
            {"superior", xyz_json(R_LF.col(2))},
            {"posterior_is", search.has_frankfurt_horizontal ? "Frankfurt horizontal" : "scan"}}}};
}

std::string search_text(const plan::LandmarkSearch& search) {
  std::string text = fmt::format(
      "{} landmarks found; directions from the symmetry of the skull "
      "and the {}\n  landmark   x mm     y mm     z mm     uncertainty",
      search.found.size(), search.has_frankfurt_horizontal ? "Frankfurt horizontal" : "scan");
  for (const auto& [landmark, uncertainty_mm] : search.found)
    text += fmt::format("\n  {:<6} {:8.1f} {:8.1f} {:8.1f}   {:4.1f} mm  {}", landmark.name,
                        landmark.point_L.x(), landmark.point_L.y(), landmark.point_L.z(),
                        uncertainty_mm, plan::full_name(landmark.name));
  for (const plan::MissingLandmark& one : search.missing)
    text += fmt::format("\n  {:<6} not found: {}", one.name, one.reason);
  return text;
}

/// Landmarks and what is known of them.
struct NotedLandmarks {
  plan::Landmarks landmarks;
  std::vector<std::string> remarks{};  ///< One for each, or none.
  std::optional<plan::LandmarkSearch> search{};
};

Result<NotedLandmarks> landmarks_before(const LandmarksJob& job, Progress& progress) {
  if (!job.find) {
    LEFORT_TRY(plan::Landmarks landmarks, io::read_landmarks(job.before));
    return NotedLandmarks{std::move(landmarks)};
  }
  io::PlanFile options;
  options.labels = job.labels;
  LEFORT_TRY(const ScannedLabels head, scan_labels(options, *job.find, nullptr, progress));
  LEFORT_TRY(plan::LandmarkSearch search,
             find_head_landmarks(head.scan.ct, head.labels, head.levels, progress));
  return NotedLandmarks{search.landmarks(), remarks_of(search), std::move(search)};
}

}  // namespace

Result<Summary> measure_landmarks(const LandmarksJob& job, Progress& progress) {
  if (job.output && job.output->extension() != ".csv")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("output file {} must end in .csv", job.output->string()));
  if (job.save) LEFORT_TRY_VOID(io::check_landmarks_ending(*job.save));
  LEFORT_TRY(const NotedLandmarks before, landmarks_before(job, progress));
  NotedLandmarks last = before;
  std::vector<plan::Measurement> after;
  if (job.after) {
    last = {};
    LEFORT_TRY(last.landmarks, io::read_landmarks(*job.after));
    LEFORT_TRY(after, plan::measure(last.landmarks));
  }
  LEFORT_TRY(const std::vector<plan::Measurement> table, plan::measure(before.landmarks));
  if (job.output) LEFORT_TRY_VOID(io::write_text(*job.output, io::cephalometric_csv(table, after)));
  if (job.save) LEFORT_TRY_VOID(io::write_landmarks(*job.save, last.landmarks, last.remarks));

  Summary summary;
  summary.text = before.search ? search_text(*before.search)
                               : fmt::format("{} landmarks", before.landmarks.size());
  summary.text += cephalometric_text(table, after);
  summary.json = {{"landmarks", before.landmarks.size()},
                  {"measurements", cephalometric_json(table, after)}};
  if (before.search) summary.json["search"] = search_json(*before.search);
  return summary;
}

}  // namespace lefort::pipeline
