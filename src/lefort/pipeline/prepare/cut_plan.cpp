#include <lefort/core/version.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/prepare/cached_field.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/predict/contact_field.h>

#include <fmt/format.h>

#include <array>
#include <string>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

struct Bone {
  std::string name;
  std::string surface;  ///< File.
  std::string field;    ///< Name in the cache.
  const geometry::TriangleMesh* surface_L;
  double volume_mm3;
};

/// In the order of the plan, the remainder last. A prediction uses the same cached fields.
std::vector<Bone> bones_of(const plan::CutSegments& cut,
                           const std::vector<plan::PlannedSegment>& planned) {
  std::vector<Bone> bones;
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const std::string& name = planned[k].osteotomy.segment;
    bones.push_back({name, fmt::format("segment_{}.vtp", name), "segment", &cut.segments_L[k],
                     cut.volumes_mm3[k]});
  }
  bones.push_back({"", "remainder.vtp", "remainder", &cut.remainder_L, cut.remainder_volume_mm3});
  return bones;
}

}  // namespace

Result<Summary> cut_plan(const CutJob& job, Progress& progress) {
  LEFORT_TRY(const io::PlanFile plan, io::read_plan(job.plan));
  io::note_warnings(plan.warnings, progress);
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const fs::path document = job.output / "cut.json";
  LEFORT_TRY_VOID(io::remove_earlier_files(std::array{document}));
  const StageCache cache(job.cache);
  LEFORT_TRY(const ScannedHead head, scan_head(plan, job.ct, cache, progress));
  progress.begin_stage("cut the bone");
  LEFORT_TRY(const plan::CutSegments cut,
             plan::cut_segments(head.skull_L, head.mandible(), plan.segments, progress));
  note_fragments(cut, plan.segments, progress);

  nlohmann::json list = nlohmann::json::array();
  std::string text = fmt::format("{}: {} segments", job.output.string(), plan.segments.size());
  for (const Bone& bone : bones_of(cut, plan.segments)) {
    const field::DistanceFieldOptions field_options = bone_field_options(plan, *bone.surface_L);
    LEFORT_TRY(const auto field,
               find_field(bone.field, *bone.surface_L, field_options, cache, progress));
    if (!field->frame().closed)
      progress.note(
          fmt::format("warning: the surface of {} is open, so overlap with it may not be "
                      "found",
                      bone.name.empty() ? "the stationary bone" : bone.name));
    LEFORT_TRY_VOID(io::write_surface(job.output / bone.surface, *bone.surface_L));
    list.push_back(
        {{"name", bone.name},
         {"surface", bone.surface},
         {"field",
          field_file(bone.field, *bone.surface_L, field_options, cache).filename().string()},
         {"volume_ml", bone.volume_mm3 * 1e-3},
         {"vertices", bone.surface_L->vertex_count()}});
    text += fmt::format("\n  {:<16} {:8.1f} ml", bone.name.empty() ? "remainder" : bone.name,
                        bone.volume_mm3 * 1e-3);
  }
  Summary summary;
  summary.text = std::move(text);
  summary.json = {{"lefort_cut", 1},
                  {"notice", kNotForClinicalUse},
                  {"version", kVersion},
                  {"skull_volume_ml", cut.skull_volume_mm3 * 1e-3},
                  {"kerf_volume_ml", cut.kerf_volume_mm3 * 1e-3},
                  {"bones", list}};
  LEFORT_TRY_VOID(io::write_text(document, summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
