#include <lefort/core/version.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/json/boundary_json.h>
#include <lefort/pipeline/prepare/interface_surface.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/preview.h>

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

/// The case on the mesh of the plan, and the live model on the mesh of a preview.
struct CaseWithPreview {
  PreparedCase prepared;
  predict::FacePreview face;
};

Result<CaseWithPreview> make_preview(const PreviewJob& job, Progress& progress) {
  LEFORT_TRY(const io::PlanText text, io::read_plan_text(job.plan));
  io::note_warnings(text.plan.warnings, progress);
  io::PlanFile plan = text.plan;
  // A preview is for any motion: the plan's paths are not used and must not cause an error.
  for (plan::PlannedSegment& segment : plan.segments) {
    segment.path.keyframes = {geometry::Keyframe{}};
    segment.path.steps = 1;
  }
  const StageCache cache(job.cache);
  LEFORT_TRY(PreparedCase prepared, prepare_case(std::move(plan), io::Sha256().add(text.json).hex(),
                                                 job.ct, cache, progress));
  LEFORT_TRY(const geometry::TriangleMesh skin_L, io::read_surface(job.skin));
  if (!is_same_skin(skin_L, prepared.skin_L, prepared.scan_grid.spacing_mm.maxCoeff()))
    return fail(ErrorCode::kPlanInvalid,
                "the skin was made with other thresholds or labels than the plan's: "
                "run the job segment again");
  progress.begin_stage("make the model of the preview");
  LEFORT_TRY(predict::FacePreview face, preview_face(prepared, skin_L, cache, progress));
  return CaseWithPreview{std::move(prepared), std::move(face)};
}

}  // namespace

Result<predict::FacePreview> load_preview(const PreviewJob& job, Progress& progress) {
  LEFORT_TRY(CaseWithPreview made, make_preview(job, progress));
  return std::move(made.face);
}

Result<PreparedPreview> prepare_preview(const PreviewJob& job, Progress& progress) {
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const fs::path document = job.output / "preview.json", interface = job.output / kInterfaceFile;
  LEFORT_TRY_VOID(io::remove_earlier_files(std::array{document, interface}));
  LEFORT_TRY(CaseWithPreview made, make_preview(job, progress));
  progress.begin_stage("write");
  LEFORT_TRY_VOID(write_interface_surface(interface, made.prepared.model));
  const std::vector<std::string> segments = made.prepared.segment_names();
  Summary summary;
  summary.json = {{"lefort_preview", 1},
                  {"notice", kNotForClinicalUse},
                  {"note", "preview, not a prediction"},
                  {"version", kVersion},
                  {"plan_sha256", made.prepared.provenance.plan_sha256},
                  {"segments", segments},
                  {"vertices", made.face.vertex_count()},
                  {"elements", made.face.element_count()},
                  {"boundary", boundary_json(made.prepared)}};
  summary.text = fmt::format("the face can be previewed for segment {}: {} elements",
                             fmt::join(segments, ", "), made.face.element_count());
  LEFORT_TRY_VOID(io::write_text(document, summary.json.dump(1) + "\n"));
  return PreparedPreview{std::move(summary), std::move(made.face)};
}

}  // namespace lefort::pipeline
