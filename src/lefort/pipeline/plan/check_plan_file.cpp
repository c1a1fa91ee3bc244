#include <lefort/anatomy/find_teeth.h>
#include <lefort/core/version.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/earlier_check_files.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental/dental_numbers.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/plan/cephalometric_table.h>
#include <lefort/pipeline/plan/nerve_file.h>
#include <lefort/pipeline/plan/worksheet.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/plan/bones_of_landmarks.h>
#include <lefort/plan/cephalometrics.h>
#include <lefort/plan/head_directions.h>
#include <lefort/predict/check_plan.h>
#include <lefort/predict/root_distances.h>
#include <lefort/report/plan_pictures.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTable = "cephalometry.csv";
constexpr const char* kMovementTable = "planned_movements.csv";
constexpr const char* kWorksheet = "worksheet.pdf";
constexpr const char* kAboutLandmarks =
    "measured in the frame of the landmarks before surgery; after surgery only landmarks on bone "
    "and teeth are known, landmarks on the skin need a prediction";

std::string surface_name(const std::string& segment) { return "segment_" + segment + ".vtp"; }
std::string transform_name(const std::string& segment) { return "segment_" + segment + ".tfm"; }

/// Files of a check except check.json and pictures, relative to its folder.
std::vector<std::string> names_of(const io::PlanFile& plan) {
  std::vector<std::string> names{"remainder.vtp", kMovementTable, kWorksheet};
  for (const plan::PlannedSegment& one : plan.segments) {
    names.push_back(surface_name(one.osteotomy.segment));
    names.push_back(transform_name(one.osteotomy.segment));
  }
  if (!plan.landmarks.empty())
    names.insert(names.end(), {"landmarks_after.mrk.json", "landmarks_after.csv", kTable});
  return names;
}

/// Removes the results of an earlier check, and no other files.
Result<void> prepare_folder(const CheckPlanJob& job, const io::PlanText& text,
                            std::span<const std::string> names) {
  LEFORT_TRY(const std::vector<fs::path> earlier, io::earlier_check_files(job.output));
  LEFORT_TRY_VOID(io::check_overwrites_only_earlier(job.output, names, earlier));
  std::vector<fs::path> inputs{job.plan};
  if (job.skull) inputs.push_back(*job.skull);
  if (job.nerve) inputs.push_back(*job.nerve);
  if (job.tooth_corrections) inputs.push_back(*job.tooth_corrections);
  for (const PrintedPart& part : job.printed) inputs.push_back(part.file);
  if (const auto& ct = job.ct ? job.ct : text.plan.ct) inputs.push_back(*ct);
  for (const std::string& name : io::files_of_plan(text.json))
    inputs.push_back(job.plan.parent_path() / name);
  LEFORT_TRY_VOID(io::check_inputs_are_distinct(inputs, earlier));
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  return io::remove_earlier_files(earlier);
}

Result<io::PlanText> read_plan(const CheckPlanJob& job, Progress& progress) {
  if (job.skull) return io::read_plan_text(job.plan);
  return read_plan_of_scan(job.plan, job.ct, StageCache(job.cache.value_or(job.output / "cache")),
                           progress);
}

/// The bones before the osteotomies; see ScannedHead.
struct Bones {
  geometry::TriangleMesh skull_L;
  std::optional<geometry::TriangleMesh> mandible_L{};
  anatomy::LabelMap labels{};                ///< Of a scan.
  std::optional<anatomy::ToothMap> teeth{};  ///< Of a scan with a labeled mandible.
  std::string ct_sha256{};                   ///< Of a scan.
};

/// Inputs and version of the check.
Result<nlohmann::json> provenance(const CheckPlanJob& job, const io::PlanText& text,
                                  const Bones& before) {
  nlohmann::json files = nlohmann::json::array();
  LEFORT_TRY(const std::vector<io::InputFile> named, io::fingerprints(text.json, job.plan));
  for (const auto& [name, sha256] : named) files.push_back({{"file", name}, {"sha256", sha256}});
  nlohmann::json inputs{{"plan_sha256", io::Sha256().add(text.json).hex()},
                        {"plan_files", files},
                        {"skull_sha256", io::Sha256().add(before.skull_L).hex()}};
  if (!before.ct_sha256.empty()) inputs["ct_sha256"] = before.ct_sha256;
  return inputs;
}

/// The skull before the osteotomies: a surface, or the bone of a scan.
Result<Bones> find_skull(const CheckPlanJob& job, const io::PlanFile& plan, Progress& progress) {
  if (job.skull) {
    progress.begin_stage("read the skull");
    LEFORT_TRY(geometry::TriangleMesh skull_L, io::read_surface(*job.skull, progress));
    return Bones{std::move(skull_L)};
  }
  LEFORT_TRY(const fs::path ct, io::scan_of(job.plan, plan, job.ct));
  LEFORT_TRY(ScannedHead head,
             scan_head(plan, ct, StageCache(job.cache.value_or(job.output / "cache")), progress));
  Bones bones{std::move(head.skull_L), std::move(head.mandible_L)};
  bones.ct_sha256 = head.ct_sha256;
  if (!has_mandible(head.labels)) return bones;
  progress.begin_stage("find teeth");
  bones.teeth = anatomy::find_teeth(head.scan.ct, head.labels, head.levels.bone_hu);
  bones.labels = std::move(head.labels);
  return bones;
}

/// Landmarks after surgery that move with bone.
struct MovedLandmarks {
  plan::Landmarks known;              ///< On bone and teeth.
  std::vector<std::string> off_bone;  ///< Hard-tissue landmarks that are not on bone: unknown.
};

/// Landmarks on bone and teeth move with their bone.
MovedLandmarks move_landmarks(const plan::Landmarks& before, const plan::CutSegments& cut,
                              const std::vector<plan::PlannedSegment>& planned) {
  const auto bones = plan::bones_of_landmarks(before, cut);
  MovedLandmarks after;
  for (std::size_t n = 0; n < before.size(); ++n) {
    plan::Landmark landmark = before[n];
    const plan::LandmarkKind* const kind = plan::landmark_definition(landmark.name);
    if (kind != nullptr && kind->is_soft) continue;
    if (!bones[n]) {
      after.off_bone.push_back(landmark.name);
      continue;
    }
    if (*bones[n] < planned.size())
      landmark.point_L = geometry::pose_at(planned[*bones[n]].path, 1.0) * landmark.point_L;
    after.known.push_back(std::move(landmark));
  }
  return after;
}

/// Adds the cuts that pass close to teeth, if these are known.
Result<void> add_root_findings(const CheckPlanJob& job, const Bones& bones,
                               const plan::CutSegments& cut, const io::PlanFile& plan,
                               predict::PlanCheck& check) {
  if (!bones.teeth) return {};
  const double limit_mm = job.limits.root_mm;
  LEFORT_TRY(const auto numbered,
             corrected_numbers(*bones.teeth, plan.landmarks, job.tooth_corrections));
  for (const predict::RootDistance& root :
       predict::root_distances(cut, plan.segments, bones.labels, *bones.teeth,
                               numbered ? &numbered->numbers : nullptr, limit_mm))
    check.findings.push_back(
        {predict::FindingKind::kToothRoot, root.segment, predict::describe(root, limit_mm)});
  return {};
}

/// Distances that are reported; findings only below the limit.
constexpr double kNearNerve_mm = 10.0;

/// Adds the cuts that pass close to the canals. \returns all distances.
nlohmann::json add_nerve_findings(std::span<const predict::NerveTube> nerves,
                                  const plan::CutSegments& cut, const io::PlanFile& plan,
                                  double limit_mm, predict::PlanCheck& check) {
  nlohmann::json distances = nlohmann::json::array();
  for (const predict::NerveDistance& found :
       predict::nerve_distances(cut, plan.segments, nerves, std::max(limit_mm, kNearNerve_mm))) {
    distances.push_back({{"segment", found.segment},
                         {"nerve", found.nerve},
                         {"distance_mm", found.distance_mm},
                         {"at_mm", as_json(found.nerve_L)}});
    if (found.distance_mm < limit_mm)
      check.findings.push_back(
          {predict::FindingKind::kNerve, found.segment, predict::describe(found, limit_mm)});
  }
  return distances;
}

using pipeline::as_json;

nlohmann::json as_json(const predict::PlanCheck& check, const plan::CutSegments& cut,
                       const std::vector<plan::PlannedSegment>& planned,
                       const predict::PlanLimits& limits) {
  nlohmann::json findings = nlohmann::json::array(), overlaps = nlohmann::json::array(),
                 segments = nlohmann::json::array();
  for (const predict::PlanFinding& finding : check.findings)
    findings.push_back({{"kind", predict::name_of(finding.kind)},
                        {"segment", finding.segment},
                        {"text", finding.text}});
  for (const predict::BoneOverlapAtFraction& pair : check.overlaps)
    overlaps.push_back({{"first", pair.first},
                        {"second", pair.second},
                        {"path_fraction", pair.path_fraction},
                        {"volume_ml", pair.overlap.volume_mm3 * 1e-3},
                        {"max_depth_mm", pair.overlap.deepest_mm},
                        {"max_depth_at_mm", as_json(pair.overlap.deepest_L)},
                        {"depth_is_lower_bound", pair.overlap.depth_is_lower_bound}});
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const predict::SegmentSupport& support = check.supports[k];
    const RigidTransform X_LB = geometry::pose_at(planned[k].path, 1.0);
    segments.push_back({{"name", support.segment},
                        {"volume_ml", cut.volumes_mm3[k] * 1e-3},
                        {"pieces", cut.cuts[k].segment_pieces},
                        {"fragments", as_json(cut.cuts[k].fragments)},
                        {"kerf_ml", cut.cuts[k].kerf_volume_mm3 * 1e-3},
                        {"pose", as_json(X_LB)},
                        {"cut_area_mm2", support.cut_area_mm2},
                        {"supported_area_mm2", support.supported_area_mm2},
                        {"mean_gap_mm", support.mean_gap_mm},
                        {"max_gap_mm", support.max_gap_mm},
                        {"max_gap_at_mm", as_json(support.max_gap_L)}});
  }
  return {{"lefort_plan_check", kPlanCheckVersion},
          {"notice", kNotForClinicalUse},
          {"version", kVersion},
          {"limits",
           {{"overlap_mm", limits.overlap_mm},
            {"gap_mm", limits.gap_mm},
            {"support_mm", limits.support_mm},
            {"support_fraction", limits.support_fraction},
            {"root_mm", limits.root_mm},
            {"nerve_mm", limits.nerve_mm}}},
          {"has_findings", !check.findings.empty()},
          {"findings", findings},
          {"overlaps", overlaps},
          {"segments", segments},
          {"skull_volume_ml", cut.skull_volume_mm3 * 1e-3},
          {"remainder_volume_ml", cut.remainder_volume_mm3 * 1e-3},
          {"kerf_volume_ml", cut.kerf_volume_mm3 * 1e-3},
          {"left_out_volume_ml", cut.left_out_volume_mm3 * 1e-3}};
}

std::string in_words(const predict::PlanCheck& check, const plan::CutSegments& cut) {
  std::string text = check.findings.empty()
                         ? std::string("the plan has no findings")
                         : fmt::format("the plan has {} finding{}:", check.findings.size(),
                                       check.findings.size() == 1 ? "" : "s");
  for (const predict::PlanFinding& finding : check.findings) text += "\n  " + finding.text;
  for (std::size_t k = 0; k < check.supports.size(); ++k) {
    const predict::SegmentSupport& support = check.supports[k];
    text += fmt::format(
        "\n  {:<16} {:7.1f} ml, {:6.0f} mm2 of cut faces, {:3.0f} % supported, gap max {:.1f} mm, "
        "mean {:.1f} mm",
        support.segment, cut.volumes_mm3[k] * 1e-3, support.cut_area_mm2,
        100.0 * support.supported_fraction(), support.max_gap_mm, support.mean_gap_mm);
  }
  return text;
}

Result<void> write_bones(const fs::path& folder, const plan::CutSegments& cut,
                         const std::vector<plan::PlannedSegment>& planned) {
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const std::string& name = planned[k].osteotomy.segment;
    const RigidTransform X_LB = geometry::pose_at(planned[k].path, 1.0);
    LEFORT_TRY_VOID(io::write_surface(folder / surface_name(name),
                                      geometry::transformed(cut.segments_L[k], X_LB)));
    LEFORT_TRY_VOID(io::write_transform(folder / transform_name(name), X_LB));
  }
  return io::write_surface(folder / "remainder.vtp", cut.remainder_L);
}

/// Adds the cephalometric tables before and after the movement. \returns them as CSV.
Result<std::string> add_cephalometry(const plan::Landmarks& before, const MovedLandmarks& after,
                                     nlohmann::json& result, std::string& text) {
  if (before.empty()) return std::string();
  LEFORT_TRY(const auto before_table, plan::measure(before));
  LEFORT_TRY(const auto after_table, plan::measure(after.known, before));
  result["cephalometry"] = cephalometric_json(before_table, after_table);
  result["cephalometry_is"] = kAboutLandmarks;
  result["landmarks_off_bone"] = after.off_bone;
  text += fmt::format("\n  cephalometry, {}:", kAboutLandmarks);
  text += cephalometric_text(before_table, after_table);
  return io::cephalometric_csv(before_table, after_table);
}

Result<void> write_landmark_files(const fs::path& folder, const plan::Landmarks& after,
                                  const std::string& table) {
  LEFORT_TRY_VOID(io::write_landmarks(folder / "landmarks_after.mrk.json", after));
  LEFORT_TRY_VOID(io::write_landmarks(folder / "landmarks_after.csv", after));
  return io::write_text(folder / kTable, table);
}

Result<void> write_movements(const fs::path& folder, const WorksheetNotes& notes,
                             std::span<const MovementOfSegment> movements,
                             std::span<const predict::PlanFinding> findings,
                             std::span<const report::PlanPicture> pictures) {
  LEFORT_TRY_VOID(io::write_text(folder / kMovementTable, movements_csv(movements)));
  LEFORT_TRY(const std::string pdf, worksheet_pdf(notes, movements, findings, pictures));
  return io::write_text(folder / kWorksheet, pdf);
}

Result<void> write_pictures(const fs::path& folder, std::span<const report::PlanPicture> pictures) {
  if (pictures.empty()) return {};
  LEFORT_TRY_VOID(io::make_output_folder(folder / "pictures"));
  for (const report::PlanPicture& picture : pictures)
    LEFORT_TRY_VOID(io::write_text(folder / "pictures" / picture.file, picture.png));
  return {};
}

Result<std::vector<WorksheetPart>> parts_of(std::span<const PrintedPart> printed) {
  std::vector<WorksheetPart> parts;
  for (const PrintedPart& part : printed) {
    LEFORT_TRY(std::string sha256, io::sha256_of_file(part.file));
    const fs::path file = fs::absolute(part.file).lexically_normal();
    // Every splint is called splint.stl: its folder distinguishes them.
    std::string name =
        part.name.empty() ? (file.parent_path().filename() / file.filename()).string() : part.name;
    parts.push_back({part.kind, std::move(name), std::move(sha256)});
  }
  return parts;
}

}  // namespace

Result<PlanCheckSummary> check_plan_file(const CheckPlanJob& job, Progress& progress) {
  LEFORT_TRY(const io::PlanText plan_text, read_plan(job, progress));
  const io::PlanFile& plan = plan_text.plan;
  io::note_warnings(plan.warnings, progress);
  LEFORT_TRY(const io::Nerves nerves, read_given_nerves(job.nerve, progress));
  LEFORT_TRY(std::vector<WorksheetPart> parts, parts_of(job.printed));
  std::vector<std::string> names = names_of(plan);
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(prepare_folder(job, plan_text, names));
  LEFORT_TRY(const Bones before, find_skull(job, plan, progress));
  LEFORT_TRY_VOID(check_same_scan(nerves, before.ct_sha256));
  LEFORT_TRY_VOID(
      check_canals_of_plan(plan_text.json, job.plan.parent_path(), before.ct_sha256, progress));
  progress.begin_stage("cut the bone");
  LEFORT_TRY(const plan::CutSegments cut,
             plan::cut_segments(before.skull_L, before.mandible_L ? &*before.mandible_L : nullptr,
                                plan.segments, progress));
  note_fragments(cut, plan.segments, progress);
  progress.begin_stage("check bone overlap");
  LEFORT_TRY(predict::PlanCheck check,
             predict::check_plan(cut, plan.segments, job.limits, plan.field, progress));
  LEFORT_TRY_VOID(add_root_findings(job, before, cut, plan, check));
  const nlohmann::json nerve =
      add_nerve_findings(nerves.canals, cut, plan, job.limits.nerve_mm, check);

  nlohmann::json result = as_json(check, cut, plan.segments, job.limits);
  if (job.nerve) result["nerve"] = nerve;
  LEFORT_TRY(const plan::HeadDirections directions, plan::head_directions(plan.landmarks));
  const auto movements = segment_movements(directions, plan.landmarks, cut, plan.segments);
  result["movements"] = movements_json(movements);
  result["movements_along"] = directions.has_frankfurt_horizontal ? "Frankfurt horizontal" : "scan";
  LEFORT_TRY(result["inputs"], provenance(job, plan_text, before));
  std::string text = in_words(check, cut);
  const MovedLandmarks after = move_landmarks(plan.landmarks, cut, plan.segments);
  LEFORT_TRY(const std::string table, add_cephalometry(plan.landmarks, after, result, text));
  for (const std::string& name : after.off_bone)
    progress.note(
        fmt::format("landmark {} is not on bone; its position after surgery is unknown", name));
  std::vector<report::PlanPicture> pictures;
  if (job.pictures) {
    progress.begin_stage("draw");
    LEFORT_TRY(pictures, report::draw_plan(cut, plan.segments, progress));
  }

  progress.begin_stage("write");
  for (const report::PlanPicture& picture : pictures) names.push_back("pictures/" + picture.file);
  LEFORT_TRY_VOID(io::check_overwrites_only_earlier(job.output, names, {}));
  result["files"] = names;
  // Written first: it lists the files that the next check may replace if this one is interrupted.
  LEFORT_TRY_VOID(io::write_text(job.output / "check.json", result.dump(2) + "\n"));
  LEFORT_TRY_VOID(write_bones(job.output, cut, plan.segments));
  if (!plan.landmarks.empty())
    LEFORT_TRY_VOID(write_landmark_files(job.output, after.known, table));
  LEFORT_TRY_VOID(write_movements(job.output,
                                  {plan.title, io::Sha256().add(plan_text.json).hex(),
                                   directions.has_frankfurt_horizontal, std::move(parts)},
                                  movements, check.findings, pictures));
  LEFORT_TRY_VOID(write_pictures(job.output, pictures));
  return PlanCheckSummary{{std::move(text), std::move(result)}, !check.findings.empty()};
}

}  // namespace lefort::pipeline
