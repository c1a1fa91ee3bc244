#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/head_from_surfaces.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/compare/compare_by_region.h>
#include <lefort/compare/recover_surgery.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/pipeline/validate/case_plan.h>
#include <lefort/pipeline/validate/set_up_case.h>
#include <lefort/plan/bone_bodies.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using geometry::TriangleMesh;

constexpr const char* kScan = "before.nrrd";
constexpr const char* kLabels = "before.seg.nrrd";

Result<TriangleMesh> read_checked(const fs::path& file) {
  LEFORT_TRY(TriangleMesh mesh_L, io::read_surface(file));
  LEFORT_TRY_VOID(geometry::check_surface(mesh_L));
  return mesh_L;
}

/// Writes scan and labels of a head that is known as surfaces.
Result<void> write_head(const SurfaceFiles& files, const fs::path& work, double voxel_mm,
                        Progress& progress) {
  anatomy::HeadSurfaces surfaces;
  LEFORT_TRY(surfaces.skin_L, io::read_surface(*files.skin));
  LEFORT_TRY(surfaces.skull_L, io::read_surface(*files.skull));
  if (files.mandible) {
    LEFORT_TRY(surfaces.mandible_L, io::read_surface(*files.mandible));
  }
  LEFORT_TRY(const anatomy::LabeledScan head,
             anatomy::scan_from_surfaces(surfaces, voxel_mm, progress));
  LEFORT_TRY_VOID(io::write_segmentation(work / kLabels, head.labels));
  return io::write_volume(work / kScan, head.ct);
}

/// The bones of a plan before surgery.
compare::PlannedBones planned_bones(const io::PlanFile& plan, const plan::CutSegments& cut) {
  compare::PlannedBones bones;
  bones.remainder_L = cut.remainder_L;
  bones.segments_B = cut.segments_L;
  for (const plan::PlannedSegment& one : plan.segments) {
    bones.segments.push_back(one.osteotomy.segment);
    bones.planned_LB.push_back(geometry::pose_at(one.path, 1.0));
    bones.kerf_mm = std::max(bones.kerf_mm, one.osteotomy.kerf_mm);
  }
  return bones;
}

/// Skin and bone after surgery, in any frame; the bone may be empty.
struct HeadAfter {
  TriangleMesh skin, bone;
};

Result<HeadAfter> read_after(const CohortCase& one, const io::PlanFile& plan,
                             const StageCache& cache, Progress& progress) {
  HeadAfter after;
  if (!one.has_after()) return after;
  if (one.after_scan) {
    io::PlanFile options;
    options.segmentation = plan.segmentation;
    LEFORT_TRY(ScannedHead head, scan_head(options, *one.after_scan, cache, progress));
    LEFORT_TRY(after.skin,
               anatomy::extract_isosurface(
                   anatomy::skin_level(head.scan.ct, head.labels, head.levels), {}, progress));
    after.bone = std::move(head.skull_L);
    return after;
  }
  LEFORT_TRY(after.skin, read_checked(*one.after.skin));
  for (const auto& file : {one.after.skull, one.after.mandible}) {
    if (!file) continue;
    LEFORT_TRY(const TriangleMesh bone, read_checked(*file));
    plan::append(after.bone, bone);
  }
  return after;
}

/// Registers the head after surgery on stationary bone. Without its skull it is in frame L.
Result<std::optional<compare::Registration>> register_after(const CohortCase& one,
                                                            const compare::PlannedBones& bones,
                                                            HeadAfter& after, Progress& progress) {
  if (!one.after_scan && !one.after.skull) return std::nullopt;
  progress.begin_stage("register on stationary bone");
  LEFORT_TRY(compare::Registration base, compare::register_remainder(bones, after.bone, progress));
  const RigidTransform X_L_after = base.X_onto_from.inverse();
  after.skin = geometry::transformed(std::move(after.skin), X_L_after);
  after.bone = geometry::transformed(std::move(after.bone), X_L_after);
  return base;
}

Result<std::vector<RigidTransform>> find_movements(const compare::PlannedBones& bones,
                                                   const TriangleMesh& bone_after_L,
                                                   Progress& progress) {
  if (bone_after_L.triangles.empty())
    return fail(ErrorCode::kPlanInvalid,
                "the movement is unknown: the case must have a plan with paths, or bone after "
                "surgery (a scan, or after_skull and after_mandible)");
  progress.begin_stage("find the movements");
  LEFORT_TRY(const std::vector<compare::AchievedMovement> found,
             compare::recover_movements(bones, bone_after_L, progress));
  std::vector<RigidTransform> poses_LB;
  for (const compare::AchievedMovement& one : found) poses_LB.push_back(one.achieved.X_onto_from);
  return poses_LB;
}

/// Landmarks of the case, or of its plan.
Result<plan::Landmarks> landmarks_of(const CohortCase& one, const io::PlanFile& plan) {
  if (one.landmarks) return io::read_landmarks(*one.landmarks);
  return plan.landmarks;
}

/// Finds landmarks in the scan if those of the case do not define all regions. Names that the case
/// has are not replaced.
Result<void> find_missing_landmarks(const ScannedHead& head, CaseSetup& setup, Progress& progress) {
  LEFORT_TRY(const compare::FaceRegions regions, compare::FaceRegions::from(setup.landmarks));
  if (regions.missing().empty()) return {};
  LEFORT_TRY(const plan::LandmarkSearch search,
             find_head_landmarks(head.scan.ct, head.labels, head.levels, progress));
  for (const plan::Landmark& found : search.landmarks())
    if (!plan::find_landmark(setup.landmarks, found.name)) setup.landmarks.push_back(found);
  setup.are_landmarks_found = true;
  return {};
}

}  // namespace

Result<CaseSetup> set_up_case(const CohortCase& one, const fs::path& work,
                              const SetupOptions& options, Progress& progress) {
  LEFORT_TRY_VOID(io::make_output_folder(work));
  if (!one.before_scan) LEFORT_TRY_VOID(write_head(one.before, work, options.voxel_mm, progress));
  const CaseFiles files{one.before_scan.value_or(work / kScan),
                        one.before_scan ? std::nullopt : std::optional<fs::path>(work / kLabels),
                        work, options.link_inputs};
  LEFORT_TRY(CasePlan draft, draft_plan(one, files, options.element_size_mm, options.parameters));
  LEFORT_TRY(const io::PlanFile plan, io::parse_plan(draft.json.dump(), work));

  CaseSetup setup;
  setup.plan = work / "plan.json";
  if (options.link_inputs) setup.ct = files.scan;
  setup.cache = options.shared_cache ? StageCache(*options.shared_cache)
                                     : StageCache(work / "prediction" / "cache");
  LEFORT_TRY(setup.landmarks, landmarks_of(one, plan));
  LEFORT_TRY(const ScannedHead head, scan_head(plan, files.scan, setup.cache, progress));
  if (one.has_after()) LEFORT_TRY_VOID(find_missing_landmarks(head, setup, progress));
  progress.begin_stage("cut the bone");
  LEFORT_TRY(setup.cut, plan::cut_segments(head.skull_L, head.mandible(), plan.segments, progress));
  const compare::PlannedBones bones = planned_bones(plan, setup.cut);
  setup.segments = bones.segments;
  setup.moved_LB = bones.planned_LB;
  LEFORT_TRY(HeadAfter after, read_after(one, plan, setup.cache, progress));
  LEFORT_TRY(setup.registration, register_after(one, bones, after, progress));
  if (options.achieved_movements) draft.lacks_movement.assign(bones.segments.size(), true);
  setup.has_achieved_movements = std::find(draft.lacks_movement.begin(), draft.lacks_movement.end(),
                                           true) != draft.lacks_movement.end();
  if (setup.has_achieved_movements) {
    LEFORT_TRY(const std::vector<RigidTransform> found_LB,
               find_movements(bones, after.bone, progress));
    for (std::size_t k = 0; k < found_LB.size(); ++k) {
      if (!draft.lacks_movement[k]) continue;
      setup.moved_LB[k] = found_LB[k];
      set_movement(draft, k, found_LB[k], bones.segments_B[k]);
    }
  }
  setup.skin_after_L = std::move(after.skin);
  LEFORT_TRY_VOID(io::write_text(setup.plan, draft.json.dump(2) + "\n"));
  return setup;
}

Result<std::vector<compare::FaceRegion>> find_regions(const CaseSetup& setup,
                                                      const TriangleMesh& skin_L) {
  LEFORT_TRY(const compare::FaceRegions regions, compare::FaceRegions::from(setup.landmarks));
  if (!regions.missing().empty())
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("landmarks that define regions of the face are neither in the case nor "
                            "found in its scan: {}",
                            fmt::join(regions.missing(), "; ")));
  std::vector<compare::FaceRegion> of_vertex = compare::regions_of(skin_L, nullptr, regions);
  if (std::all_of(of_vertex.begin(), of_vertex.end(), [](compare::FaceRegion region) {
        return region == compare::FaceRegion::kElsewhere;
      }))
    return fail(
        ErrorCode::kAnatomyMissing,
        "no point of the skin lies in a region of the face: are the landmarks of this head, "
        "and in LPS?");
  return of_vertex;
}

}  // namespace lefort::pipeline
