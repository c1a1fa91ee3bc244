#include <lefort/inverse/target_spec.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/target_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/optimize.h>
#include <lefort/pipeline/optimize/optimization.h>
#include <lefort/pipeline/optimize/optimization_report.h>
#include <lefort/pipeline/optimize/optimized_plan.h>
#include <lefort/pipeline/predict.h>
#include <lefort/pipeline/prepare/cached_field.h>
#include <lefort/pipeline/prepare/coarse_face.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/timing/stage_timer.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/path_overlaps.h>
#include <lefort/report/report_html.h>

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// Residual of the equilibria of the coarse model, for exact derivatives.
constexpr double kCoarseTolerance = 1e-9;

const char* const kPictureFolder = "pictures";

/// Options of a live model of the plan's face. The coarse model has contact by quadrature:
/// weighted gaps have no derivatives (predict/face_response.h).
predict::PredictionOptions coarse_options(const io::PlanFile& plan) {
  predict::PredictionOptions options{coarse_tissue(plan.tissue), plan.boundary, plan.contact,
                                     plan.solver};
  options.contact.integration = contact::Integration::kQuadrature;
  options.contact.detection = contact::DetectionMethod::kSmooth;
  options.solver.relative_tolerance = kCoarseTolerance;
  return options;
}

/// A live model and what it refers to. Does not move.
struct Model {
  predict::FaceModel face;
  std::unique_ptr<predict::FaceResponse> response;
  inverse::LiveFace live;
};

Result<void> bring_to_life(Model& model, const PreparedCase& prepared,
                           const predict::PredictionOptions& options, Progress& progress) {
  LEFORT_TRY(model.response, predict::FaceResponse::create(model.face, prepared.segment_names(),
                                                           options, progress));
  model.live = {model.response.get(),
                predict::embed_skin(
                    prepared.skin_L, model.face.tissue,
                    predict::embedding_distance_mm(options.tissue, prepared.scan_grid.spacing_mm))};
  return {};
}

/// Whether a vertex of the skin follows the tissue of the mesh.
std::vector<char> moved_vertices(const predict::SkinEmbedding& embedding) {
  std::vector<char> is_moved;
  for (const auto& vertex : embedding.embedded_vertices)
    is_moved.push_back(!vertex.weights.isZero(0.0) || !vertex.middle_weights.isZero(0.0));
  return is_moved;
}

/// Bones whose overlap is limited.
Result<inverse::BoneClearance> clearance_of(const PreparedCase& prepared, double allowed_mm,
                                            const StageCache& cache, Progress& progress) {
  const geometry::TriangleMesh& remainder_L = prepared.cut.remainder_L;
  LEFORT_TRY(const auto field,
             find_field("remainder", remainder_L, bone_field_options(prepared.plan, remainder_L),
                        cache, progress));
  const std::vector<std::string> names = prepared.segment_names();
  std::vector<predict::MovingBone> bones;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const predict::ContactBone& segment = prepared.model.segments[k];
    LEFORT_TRY(bones.emplace_back(),
               predict::make_moving_bone(names[k], segment.surface_B, nullptr, segment.field_B));
  }
  LEFORT_TRY(bones.emplace_back(),
             predict::make_moving_bone(predict::kRemainder, remainder_L, nullptr, field));
  return inverse::BoneClearance(std::move(bones), allowed_mm);
}

std::vector<Vec3> centroids(const PreparedCase& prepared) {
  std::vector<Vec3> centers;
  for (const geometry::TriangleMesh& segment_L : prepared.cut.segments_L) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& vertex : segment_L.vertices) sum += vertex;
    centers.push_back(sum / double(segment_L.vertices.size()));
  }
  return centers;
}

/// What a search needs; referenced by its result.
struct Problem {
  PreparedCase prepared;
  io::TargetText target;
  std::string plan_text;
  fs::path ct;
};

Result<Problem> read_problem(const OptimizeJob& job, const StageCache& cache, Progress& progress) {
  LEFORT_TRY(io::TargetText target, io::read_target(job.target, progress));
  LEFORT_TRY(io::PlanText text, read_plan_of_scan(job.plan, job.ct, cache, progress));
  io::note_warnings(text.plan.warnings, progress);
  LEFORT_TRY(const fs::path ct, io::scan_of(job.plan, text.plan, job.ct));
  const std::string sha256 = io::Sha256().add(text.json).hex();
  LEFORT_TRY(PreparedCase prepared,
             prepare_case(std::move(text.plan), sha256, ct, cache, progress));
  return Problem{std::move(prepared), std::move(target), std::move(text.json), ct};
}

/// Results of an earlier run, optimize.json first.
Result<void> remove_earlier(const fs::path& folder) {
  const std::vector<fs::path> files{folder / "optimize.json", folder / "report.html",
                                    folder / "plan.json"};
  return io::remove_earlier_files(files);
}

/// Displacement of the skin by the full prediction of the new plan.
Result<std::vector<Vec3>> certify(const OptimizeJob& job, const Problem& problem,
                                  Progress& progress) {
  const fs::path folder = job.output / "prediction";
  LEFORT_TRY([[maybe_unused]] const Summary predicted,
             predict_case({.plan = job.output / "plan.json",
                           .ct = problem.ct,
                           .output = folder,
                           .pictures = job.pictures,
                           .sensitivity = false},
                          progress));
  LEFORT_TRY(const geometry::TriangleMesh skin_L,
             io::read_surface(folder / "predicted_skin.vtp", progress));
  const geometry::TriangleMesh& before_L = problem.prepared.skin_L;
  if (skin_L.vertices.size() != before_L.vertices.size())
    return fail(ErrorCode::kFileCorrupt, "predicted_skin.vtp is not the skin of this scan");
  std::vector<Vec3> displacement_mm;
  for (std::size_t v = 0; v < skin_L.vertices.size(); ++v)
    displacement_mm.push_back(skin_L.vertices[v] - before_L.vertices[v]);
  return displacement_mm;
}

Result<void> write_results(const OptimizeJob& job, const Optimization& done, StageTimer& progress) {
  std::vector<OptimizationPicture> pictures;
  if (job.pictures) {
    progress.begin_stage("draw");
    LEFORT_TRY(pictures, draw_optimization(done, progress));
    LEFORT_TRY_VOID(io::make_output_folder(job.output / kPictureFolder));
    for (const OptimizationPicture& picture : pictures)
      LEFORT_TRY_VOID(io::write_text(job.output / kPictureFolder / picture.file, picture.png));
  }
  LEFORT_TRY_VOID(io::write_text(job.output / "report.html",
                                 report::report_html(optimization_report(done, pictures))));
  nlohmann::ordered_json json = optimize_json(done);
  json["seconds"] = progress.seconds_json();
  return io::write_text(job.output / "optimize.json", json.dump(2) + "\n");
}

Summary summarize(const OptimizeJob& job, const Optimization& done) {
  const std::vector<TargetResult> targets = target_results(done);
  Summary summary;
  std::size_t reached = 0;
  for (const TargetResult& one : targets) reached += one.is_reached ? 1U : 0U;
  summary.text = fmt::format("{}: {} of {} targets reached, objective {:.4g} mm^2, before {:.4g}",
                             job.output.string(), reached, targets.size(),
                             inverse::objective_mm2(done.certified), done.start_objective);
  for (const TargetResult& one : targets)
    if (!one.is_reached)
      summary.text += fmt::format("\n  {}: {:.2f} mm from the target; {}", one.name,
                                  one.reached.rms_mm, one.reason);
  summary.json = optimize_json(done);
  return summary;
}

/// The search with the coarse model and, if wanted, the model of the plan.
Result<inverse::MotionResult> search(const OptimizeJob& job, const Problem& problem,
                                     const inverse::MotionProblem& motion, Model& coarse,
                                     Model& fine, Progress& progress) {
  progress.begin_stage("optimize");
  inverse::MotionOptions options;
  if (!job.check_gradient) options.check_step = 0.0;
  options.max_corrections = std::max(job.max_corrections, 1);
  if (job.max_corrections > 0)
    LEFORT_TRY_VOID(bring_to_life(fine, problem.prepared,
                                  {problem.prepared.plan.tissue, problem.prepared.plan.boundary,
                                   problem.prepared.plan.contact, problem.prepared.plan.solver},
                                  progress));
  return inverse::optimize_motion(
      coarse.live, job.max_corrections > 0 ? &fine.live : nullptr, motion, motion.variables.start(),
      options, [&](const std::string& text) { progress.note("  " + text); }, progress);
}

}  // namespace

Result<Summary> optimize_plan(const OptimizeJob& job, Progress& inner) {
  StageTimer progress(inner);
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const StageCache cache(job.output / "prediction" / "cache");
  LEFORT_TRY(const Problem problem, read_problem(job, cache, progress));
  LEFORT_TRY_VOID(remove_earlier(job.output));
  const PreparedCase& prepared = problem.prepared;
  const inverse::TargetSpec& spec = problem.target.target;

  const std::vector<geometry::RigidPath> paths = prepared.paths();
  LEFORT_TRY(std::vector<inverse::RigidBody> bodies,
             inverse::bodies_of(spec, paths, centroids(prepared)));
  LEFORT_TRY(const inverse::MotionVariables variables,
             inverse::MotionVariables::create(std::move(bodies), paths.size()));
  LEFORT_TRY(const inverse::BoneClearance clearance,
             clearance_of(prepared, spec.overlap_mm, cache, progress));

  const predict::PredictionOptions options = coarse_options(prepared.plan);
  Model coarse, fine;
  LEFORT_TRY(coarse.face,
             remodel_face(prepared, options.tissue, options.boundary, cache, progress));
  LEFORT_TRY_VOID(bring_to_life(coarse, prepared, options, progress));
  LEFORT_TRY(inverse::FaceTarget target,
             inverse::apply_target(spec, prepared.skin_L, prepared.plan.landmarks));
  LEFORT_TRY(const inverse::FaceObserver observer,
             inverse::FaceObserver::create(prepared.skin_L, moved_vertices(coarse.live.embedding),
                                           std::move(target)));
  fine.face = prepared.model;
  const inverse::MotionProblem motion{observer, variables, clearance, spec.regularization};
  LEFORT_TRY(const inverse::MotionResult result,
             search(job, problem, motion, coarse, fine, progress));

  const std::string plan =
      with_movements(problem.plan_text, movements_at(variables, result.face.x));
  LEFORT_TRY_VOID(io::write_text(job.output / "plan.json",
                                 io::portable_plan(plan, job.plan, problem.ct, job.output)));
  LEFORT_TRY(std::vector<Vec3> certified_mm, certify(job, problem, progress));
  std::vector<inverse::Observation> certified = observer.observe(certified_mm);
  const std::vector<Vec3> rest(certified_mm.size(), Vec3::Zero());
  const Optimization done{prepared,
                          spec,
                          io::Sha256().add(problem.target.json).hex(),
                          observer,
                          variables,
                          result,
                          spec.overlap_mm,
                          options.tissue.element_size_mm,
                          std::move(certified_mm),
                          std::move(certified),
                          inverse::objective_mm2(observer.observe(rest))};
  LEFORT_TRY_VOID(write_results(job, done, progress));
  if (!result.converged)
    return fail(ErrorCode::kNotConverged,
                fmt::format("the search did not converge within {} corrections; the best movement "
                            "so far is in {}",
                            job.max_corrections, (job.output / "plan.json").string()));
  return summarize(job, done);
}

}  // namespace lefort::pipeline
