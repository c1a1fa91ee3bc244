#include <lefort/core/version.h>
#include <lefort/geometry/pseudonormals.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/validate.h>
#include <lefort/pipeline/validate/phantom_case.h>
#include <lefort/pipeline/validate/run_case.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/predict_face.h>

#include <fmt/format.h>

#include <system_error>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

// The faces are made on the mesh of the plans: on another mesh, the fit would absorb the difference
// of the meshes, which on coarse meshes exceeds the effect of the parameters.
constexpr double kTruthElementFactor = 1.0;

/// The skin before surgery, and its displacement.
struct SolvedSkin {
  geometry::TriangleMesh before_L;
  std::vector<Vec3> displacement_mm;
};

Result<SolvedSkin> solve_skin(io::PlanFile plan, const std::string& plan_sha256, const fs::path& ct,
                              const fs::path& cache, Progress& progress) {
  LEFORT_TRY(PreparedCase prepared,
             prepare_case(std::move(plan), plan_sha256, ct, StageCache(cache), progress));
  progress.begin_stage("solve");
  const io::PlanFile& used = prepared.plan;
  LEFORT_TRY(
      const predict::FacePrediction prediction,
      predict::predict_face(prepared.model, prepared.paths(),
                            {used.tissue, used.boundary, used.contact, used.solver}, {}, progress));
  if (!prediction.converged())
    return fail(ErrorCode::kNotConverged,
                fmt::format("{} of {} steps converged, then {}", prediction.steps.size(),
                            prepared.steps(), prediction.failure->message));
  const auto skin_mm = predict::skin_displacement(
      predict::embed_skin(
          prepared.skin_L, prepared.model.tissue,
          predict::embedding_distance_mm(used.tissue, prepared.scan_grid.spacing_mm)),
      prediction.steps.back().displacement_mm);
  return SolvedSkin{std::move(prepared.skin_L), skin_mm};
}

/// The skin as measured after surgery: with noise along its normals.
geometry::TriangleMesh measured_skin(const SolvedSkin& skin, double noise_mm, std::uint64_t seed) {
  geometry::TriangleMesh after_L = predict::displaced(skin.before_L, skin.displacement_mm);
  const geometry::Pseudonormals normals(after_L);
  const geometry::TriangleMesh exact_L = after_L;
  for (Index v = 0; v < after_L.vertex_count(); ++v)
    after_L.vertices[std::size_t(v)] += noise_mm *
                                        random_field(exact_L.vertices[std::size_t(v)], seed) *
                                        normals.at_vertex(exact_L, v).normalized();
  return after_L;
}

/// Writes the files of one case.
Result<nlohmann::ordered_json> make_case(const PhantomCohortJob& job, const PhantomTruth& truth,
                                         const PhantomCase& one, Progress& progress) {
  const fs::path folder = job.output / one.name, hidden = job.output / ".work";
  LEFORT_TRY_VOID(io::make_output_folder(folder));
  progress.begin_stage("scan the synthetic head");
  const anatomy::LabeledScan scan = phantom_scan(job, one);
  LEFORT_TRY_VOID(io::write_volume(folder / "before.nrrd", scan.ct));
  LEFORT_TRY_VOID(io::write_segmentation(folder / kPhantomLabels, scan.labels));
  LEFORT_TRY_VOID(io::write_landmarks(folder / "landmarks.mrk.json", phantom_landmarks(one)));
  const std::string text = one.plan.dump(2) + "\n";
  LEFORT_TRY_VOID(io::write_text(folder / "plan.json", text));
  LEFORT_TRY(io::PlanFile plan, io::parse_plan(text, folder));
  plan.tissue.element_size_mm *= kTruthElementFactor;
  plan.tissue.skin->young_mpa = truth.skin_ratio * plan.tissue.young_mpa;
  plan.tissue.poisson = truth.poisson;
  const Result<SolvedSkin> skin = solve_skin(std::move(plan), io::Sha256().add(text).hex(),
                                             folder / "before.nrrd", hidden, progress);
  std::error_code ignored;
  fs::remove_all(hidden, ignored);
  if (!skin) return tl::unexpected(skin.error());
  LEFORT_TRY_VOID(io::write_surface(folder / "after_skin.ply",
                                    measured_skin(*skin, job.skin_noise_mm, one.seed)));
  return nlohmann::ordered_json{{"case", one.name},
                                {"procedure", one.procedure},
                                {"seed", one.seed},
                                {"scale", {one.scale.x(), one.scale.y(), one.scale.z()}}};
}

/// Draws and makes a case. A head whose bone cannot be cut or whose face cannot be solved is drawn
/// again with another seed.
Result<nlohmann::ordered_json> make_drawn_case(const PhantomCohortJob& job,
                                               const PhantomTruth& truth, int number,
                                               Progress& progress) {
  constexpr int kAttempts = 20;
  for (int attempt = 0;; ++attempt) {
    const PhantomCase one = draw_case(job, number, attempt);
    auto made = make_case(job, truth, one, progress);
    if (made) return *std::move(made);
    if (!is_of_case(made.error()) || attempt + 1 == kAttempts)
      return fail(made.error().code, fmt::format("{}: {}", one.name, made.error().message));
    progress.note(fmt::format("{} is drawn again: {}", one.name, made.error().message));
  }
}

}  // namespace

Result<Summary> make_phantom_cohort(const PhantomCohortJob& job, Progress& progress) {
  std::error_code error;
  if (fs::exists(job.output, error) && !fs::is_empty(job.output, error))
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("{} is not empty, expected an empty folder", job.output.string()));
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const PhantomTruth truth = draw_truth(job.seed);
  nlohmann::ordered_json document{
      {"lefort_phantom_cohort", 1},
      {"version", kVersion},
      {"seed", job.seed},
      {"parameters", {{"skin_ratio", truth.skin_ratio}, {"poisson", truth.poisson}}},
      {"element_size_mm", kTruthElementFactor * job.element_size_mm},
      {"skin_noise_mm", job.skin_noise_mm},
      {"noise_hu", job.noise_hu},
      {"cases", nlohmann::ordered_json::array()}};
  for (int k = 0; k < job.cases; ++k) {
    CaseProgress of_case(fmt::format("case {} of {}: ", k + 1, job.cases), progress);
    LEFORT_TRY(auto made, make_drawn_case(job, truth, k, of_case));
    document["cases"].push_back(std::move(made));
  }
  LEFORT_TRY_VOID(io::write_text(job.output / "truth.json", document.dump(2) + "\n"));
  return Summary{fmt::format("{}: {} synthetic cases; their parameters are in truth.json",
                             job.output.string(), job.cases),
                 document};
}

}  // namespace lefort::pipeline
