#include <lefort/app/cephalometric_table.h>
#include <lefort/app/output_folder.h>
#include <lefort/app/pipeline.h>
#include <lefort/app/plan_inputs.h>
#include <lefort/app/plan_pictures.h>
#include <lefort/app/scan_head.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/plan/bone_path.h>
#include <lefort/plan/cephalometrics.h>
#include <lefort/predict/check_plan.h>

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace lefort::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string surface_name(const std::string& segment) { return "segment_" + segment + ".vtp"; }

/// Removes what an earlier run has written, so that nothing stale stands beside new findings.
Result<void> remove_earlier(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const char* name : {"check.json", "cephalometry.csv", "landmarks_after.mrk.json",
                           "landmarks_after.csv", "remainder.vtp"})
    files.push_back(folder / name);
  std::error_code error;
  for (const fs::path& where : {folder, folder / "pictures"})
    for (const auto& entry : fs::directory_iterator(where, error)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("segment_") || name.starts_with("plan_")) files.push_back(entry.path());
    }
  return remove_earlier_files(files);
}

/// The skull that is to be cut: a surface, or the bone of a scan.
Result<geometry::TriangleMesh> find_skull(const CheckPlanJob& job, const io::PlanFile& plan,
                                          Progress& progress) {
  if (job.skull) {
    progress.begin_stage("read the skull");
    return io::read_surface(*job.skull);
  }
  LEFORT_TRY(const fs::path ct, scan_of(job.plan, plan, job.ct));
  LEFORT_TRY(ScannedHead head, scan_head(plan, ct, StageCache(job.output / "cache"), progress));
  return std::move(head.skull_L);
}

/// Landmarks on bone and teeth go with the bone they lie on; others stay.
plan::Landmarks move_landmarks(const plan::Landmarks& before, const plan::CutSegments& cut,
                               const std::vector<plan::PlannedSegment>& planned) {
  constexpr double kOnBone_mm = 5.0;  // How far a landmark that was picked may be off.
  std::vector<geometry::Bvh> trees;
  for (const geometry::TriangleMesh& segment : cut.segments_L) trees.emplace_back(segment);
  const geometry::Bvh still(cut.remainder_L);
  plan::Landmarks after = before;
  for (plan::Landmark& landmark : after) {
    const plan::LandmarkKind* const kind = plan::find_kind(landmark.name);
    if (kind != nullptr && kind->is_soft) continue;
    const Vec3 p_B = landmark.point_L;
    double nearest_mm = kOnBone_mm;
    if (const auto on_still = still.closest_point(p_B, nearest_mm))
      nearest_mm = on_still->distance_mm;
    for (std::size_t k = 0; k < planned.size(); ++k) {
      const auto on_segment = trees[k].closest_point(p_B, nearest_mm);
      if (!on_segment || !(on_segment->distance_mm < nearest_mm)) continue;
      nearest_mm = on_segment->distance_mm;
      landmark.point_L = plan::pose_at(planned[k].path, 1.0) * p_B;
    }
  }
  return after;
}

json as_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

json as_json(const predict::PlanCheck& check, const plan::CutSegments& cut,
             const std::vector<plan::PlannedSegment>& planned) {
  json findings = json::array(), overlaps = json::array(), segments = json::array();
  for (const predict::PlanFinding& finding : check.findings)
    findings.push_back({{"kind", predict::name_of(finding.kind)},
                        {"segment", finding.segment},
                        {"text", finding.text}});
  for (const predict::BonePair& pair : check.overlaps)
    overlaps.push_back({{"first", pair.first},
                        {"second", pair.second},
                        {"share", pair.share},
                        {"volume_ml", pair.overlap.volume_mm3 * 1e-3},
                        {"deepest_mm", pair.overlap.deepest_mm},
                        {"deepest_at_mm", as_json(pair.overlap.deepest_L)},
                        {"is_deeper", pair.overlap.is_beyond_reach}});
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const predict::SegmentSupport& support = check.supports[k];
    const RigidTransform X_LB = plan::pose_at(planned[k].path, 1.0);
    json pose = json::array();
    for (Index row = 0; row < 4; ++row)
      for (Index column = 0; column < 4; ++column) pose.push_back(X_LB.matrix()(row, column));
    segments.push_back({{"name", support.segment},
                        {"volume_ml", cut.volumes_mm3[k] * 1e-3},
                        {"pieces", cut.cuts[k].segment_pieces},
                        {"pieces_left_behind", cut.cuts[k].crumbs},
                        {"kerf_ml", cut.cuts[k].kerf_volume_mm3 * 1e-3},
                        {"pose", pose},
                        {"cut_area_mm2", support.cut_area_mm2},
                        {"supported_area_mm2", support.supported_area_mm2},
                        {"mean_gap_mm", support.mean_gap_mm},
                        {"largest_gap_mm", support.largest_gap_mm},
                        {"largest_gap_at_mm", as_json(support.largest_gap_L)}});
  }
  return {{"lefort_plan_check", 1},
          {"possible", check.findings.empty()},
          {"findings", findings},
          {"overlaps", overlaps},
          {"segments", segments},
          {"skull_volume_ml", cut.skull_volume_mm3 * 1e-3},
          {"remainder_volume_ml", cut.remainder_volume_mm3 * 1e-3},
          {"kerf_volume_ml", cut.kerf_volume_mm3 * 1e-3}};
}

std::string in_words(const predict::PlanCheck& check, const plan::CutSegments& cut) {
  std::string text =
      check.findings.empty()
          ? std::string("nothing was found against the plan")
          : fmt::format("the plan cannot be done as it is, {} finding{}:", check.findings.size(),
                        check.findings.size() == 1 ? "" : "s");
  for (const predict::PlanFinding& finding : check.findings) text += "\n  " + finding.text;
  for (std::size_t k = 0; k < check.supports.size(); ++k) {
    const predict::SegmentSupport& support = check.supports[k];
    text += fmt::format(
        "\n  {:<16} {:7.1f} ml, {:6.0f} mm2 of cut faces, {:3.0f} % supported, gap {:.1f} mm at "
        "most, {:.1f} mm in the mean",
        support.segment, cut.volumes_mm3[k] * 1e-3, support.cut_area_mm2,
        100.0 * support.supported_share(), support.largest_gap_mm, support.mean_gap_mm);
  }
  return text;
}

Result<void> write_bones(const fs::path& folder, const plan::CutSegments& cut,
                         const std::vector<plan::PlannedSegment>& planned) {
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const std::string& name = planned[k].osteotomy.segment;
    const RigidTransform X_LB = plan::pose_at(planned[k].path, 1.0);
    LEFORT_TRY_VOID(io::write_surface(folder / surface_name(name),
                                      geometry::transformed(cut.segments_L[k], X_LB)));
    LEFORT_TRY_VOID(io::write_transform(folder / ("segment_" + name + ".tfm"), X_LB));
  }
  return io::write_surface(folder / "remainder.vtp", cut.remainder_L);
}

}  // namespace

Result<PlanCheckSummary> check_plan_file(const CheckPlanJob& job, Progress& progress) {
  LEFORT_TRY(const io::PlanFile plan, io::read_plan(job.plan));
  LEFORT_TRY_VOID(make_output_folder(job.output));
  LEFORT_TRY_VOID(remove_earlier(job.output));
  LEFORT_TRY(const geometry::TriangleMesh skull_L, find_skull(job, plan, progress));

  progress.begin_stage("cut the bone");
  LEFORT_TRY(const plan::CutSegments cut, plan::cut_segments(skull_L, plan.segments, progress));
  for (const plan::CutBones& bones : cut.cuts) tell_crumbs(bones, progress);
  progress.begin_stage("bone against bone");
  LEFORT_TRY(const predict::PlanCheck check,
             predict::check_plan(cut, plan.segments, job.limits, plan.field, progress));

  json result = as_json(check, cut, plan.segments);
  std::string text = in_words(check, cut);
  std::string table;
  plan::Landmarks after;
  if (!plan.landmarks.empty()) {
    after = move_landmarks(plan.landmarks, cut, plan.segments);
    LEFORT_TRY(const auto before_table, plan::measure(plan.landmarks));
    LEFORT_TRY(const auto after_table, plan::measure(after, plan.landmarks));
    result["cephalometry"] = cephalometric_json(before_table, after_table);
    text += cephalometric_text(before_table, after_table);
    table = io::cephalometric_csv(before_table, after_table);
  }
  std::vector<PlanPicture> pictures;
  if (job.pictures) {
    progress.begin_stage("draw");
    LEFORT_TRY(pictures, draw_plan(cut, plan.segments, progress));
  }

  progress.begin_stage("write");
  LEFORT_TRY_VOID(write_bones(job.output, cut, plan.segments));
  if (!after.empty()) {
    LEFORT_TRY_VOID(io::write_landmarks(job.output / "landmarks_after.mrk.json", after));
    LEFORT_TRY_VOID(io::write_landmarks(job.output / "landmarks_after.csv", after));
    LEFORT_TRY_VOID(io::write_text(job.output / "cephalometry.csv", table));
  }
  if (!pictures.empty()) LEFORT_TRY_VOID(make_output_folder(job.output / "pictures"));
  for (const PlanPicture& picture : pictures)
    LEFORT_TRY_VOID(io::write_text(job.output / "pictures" / picture.file, picture.png));
  LEFORT_TRY_VOID(io::write_text(job.output / "check.json", result.dump(2) + "\n"));
  return PlanCheckSummary{{std::move(text), std::move(result)}, check.findings.empty()};
}

}  // namespace lefort::app
