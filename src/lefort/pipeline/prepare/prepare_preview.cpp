#include <lefort/core/version.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/preview_file.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/json/boundary_json.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/prepare/interface_surface.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/predict/face_preview.h>

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// Whether two skins have corresponding vertices: the same triangles, and vertices that smoothing
/// moved by at most half a voxel (geometry/smooth_surface.h).
bool is_same_skin(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b,
                  double voxel_mm) {
  if (a.vertices.size() != b.vertices.size() || a.triangles != b.triangles) return false;
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    if ((a.vertices[v] - b.vertices[v]).norm() > 0.51 * voxel_mm) return false;
  return true;
}

}  // namespace

Result<Summary> prepare_preview(const PreviewJob& job, Progress& progress) {
  LEFORT_TRY(const io::PlanText text, io::read_plan_text(job.plan));
  io::note_warnings(text.plan.warnings, progress);
  io::PlanFile plan = text.plan;
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const fs::path document = job.output / "preview.json", file = job.output / "face.preview",
                 interface = job.output / kInterfaceFile;
  LEFORT_TRY_VOID(io::remove_earlier_files(std::array{document, file, interface}));
  // A preview is for any motion: the plan's paths are not used and must not cause an error.
  for (plan::PlannedSegment& segment : plan.segments) {
    segment.path.keyframes = {geometry::Keyframe{}};
    segment.path.steps = 1;
  }
  plan.tissue.element_order = 1;  // A preview is linear, and fast.
  LEFORT_TRY(const PreparedCase prepared,
             prepare_case(std::move(plan), io::Sha256().add(text.json).hex(), job.ct,
                          StageCache(job.cache), progress));
  LEFORT_TRY(const geometry::TriangleMesh skin_L, io::read_surface(job.skin));
  if (!is_same_skin(skin_L, prepared.skin_L, prepared.scan_grid.spacing_mm.maxCoeff()))
    return fail(ErrorCode::kPlanInvalid,
                "the skin was made with other thresholds or labels than the plan's: "
                "run the job segment again");
  progress.begin_stage("linearize about the reference configuration");
  LEFORT_TRY(const predict::PreviewModel model,
             predict::make_preview_model(prepared.model, prepared.skin_L, prepared.plan.tissue,
                                         prepared.plan.boundary, prepared.scan_grid.spacing_mm));
  progress.begin_stage("write");
  LEFORT_TRY_VOID(io::write_preview_model(file, model));
  LEFORT_TRY_VOID(write_interface_surface(interface, prepared.model));
  Summary summary;
  std::vector<std::string> segments;
  for (const plan::PlannedSegment& segment : prepared.plan.segments)
    segments.push_back(segment.osteotomy.segment);
  summary.json = {{"lefort_preview", 1},
                  {"notice", kNotForClinicalUse},
                  {"note", "preview, not a prediction"},
                  {"version", kVersion},
                  {"segments", segments},
                  {"vertices", skin_L.vertex_count()},
                  {"elements", prepared.model.tissue.element_count()},
                  {"boundary", boundary_json(prepared)}};
  summary.text = fmt::format("the face can be previewed for segment {}: {} elements",
                             fmt::join(segments, ", "), prepared.model.tissue.element_count());
  LEFORT_TRY_VOID(io::write_text(document, summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
