#include <lefort/compare/surface_difference.h>
#include <lefort/core/version.h>
#include <lefort/geometry/bvh.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/validate/calibration_case.h>
#include <lefort/pipeline/validate/case_plan.h>
#include <lefort/pipeline/validate/run_case.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/predict_face.h>

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

// Increase when results of the same inputs change.
constexpr const char* kCalibrationRevision = "calibrate-3";
constexpr std::uintmax_t kMaxEvaluation = 1 << 30;  // Bytes.
constexpr std::size_t kDigest = 64;                 // Hexadecimal digits of SHA-256.

/// A stored evaluation: 'D' and pairs of distance and area as bytes of doubles, or 'F' and the
/// reason of a failure; preceded by their SHA-256. For this machine only.
std::string stored_text(const Result<CaseResidual>& residual) {
  std::string body;
  if (residual) {
    body = "D";
    for (const std::vector<double>* list : {&residual->signed_mm, &residual->weight})
      body.append(reinterpret_cast<const char*>(list->data()), list->size() * sizeof(double));
  } else {
    body = "F" + residual.error().message;
  }
  return io::Sha256().add(body).hex() + body;
}

std::optional<Result<CaseResidual>> read_stored(const fs::path& file) {
  const Result<std::string> text = io::read_text(file, kMaxEvaluation);
  if (!text || text->size() <= kDigest) return std::nullopt;
  const std::string body = text->substr(kDigest);
  if (io::Sha256().add(body).hex() != text->substr(0, kDigest)) return std::nullopt;
  if (body.front() == 'F') return fail(ErrorCode::kNotConverged, body.substr(1));
  const std::size_t count = (body.size() - 1) / (2 * sizeof(double));
  CaseResidual residual{std::vector<double>(count), std::vector<double>(count)};
  std::memcpy(residual.signed_mm.data(), body.data() + 1, count * sizeof(double));
  std::memcpy(residual.weight.data(), body.data() + 1 + count * sizeof(double),
              count * sizeof(double));
  return residual;
}

}  // namespace

/// The skin before surgery, its regions, and the achieved face.
struct CalibrationCase::Face {
  std::vector<std::size_t> vertices;  ///< Of the skin before surgery in a region of the face.
  std::vector<double> area_mm2;       ///< Of these vertices.
  geometry::Bvh achieved_L;
};

Result<CalibrationCase> CalibrationCase::open(const CohortCase& one, const fs::path& work,
                                              const SetupOptions& setup,
                                              std::vector<CalibrationParameter> parameters) {
  CalibrationCase opened;
  opened.one_ = one;
  opened.work_ = work;
  opened.setup_options_ = setup;
  opened.parameters_ = std::move(parameters);
  LEFORT_TRY(opened.inputs_sha256_, fingerprint_case(one));
  return opened;
}

fs::path CalibrationCase::file_of(std::span<const double> values) const {
  io::Sha256 hash;
  hash.add(kCalibrationRevision)
      .add(kVersion)
      .add(inputs_sha256_)
      .add(setup_options_.achieved_movements ? 1.0 : 0.0)
      .add(setup_options_.element_size_mm.value_or(0.0))
      .add(setup_options_.voxel_mm);
  for (std::size_t p = 0; p < parameters_.size(); ++p) hash.add(parameters_[p].name).add(values[p]);
  return work_ / "evaluations" / (hash.hex().substr(0, 32) + ".fit");
}

Result<void> CalibrationCase::set_up(Progress& progress) {
  if (setup_) return {};
  LEFORT_TRY(setup_, set_up_case(one_, work_, setup_options_, progress));
  return {};
}

Result<std::vector<double>> CalibrationCase::values_of_plan() {
  const CaseFiles files{one_.before_scan.value_or(work_ / "before.nrrd"), std::nullopt, work_};
  LEFORT_TRY(const CasePlan draft, draft_plan(one_, files, setup_options_.element_size_mm));
  LEFORT_TRY(plan_, io::parse_plan(draft.json.dump(), work_));
  std::vector<double> values;
  for (const CalibrationParameter& parameter : parameters_)
    values.push_back(parameter.value(parameter.coordinate(parameter.get(*plan_))));
  return values;
}

void CalibrationCase::release() {
  prepared_.reset();
  prepared_values_.clear();
}

Result<void> CalibrationCase::prepare(std::span<const double> values, Progress& progress) {
  LEFORT_TRY_VOID(set_up(progress));
  bool is_current = prepared_.has_value();
  for (std::size_t p = 0; p < parameters_.size() && is_current; ++p)
    is_current = !parameters_[p].changes_mesh || values[p] == prepared_values_[p];
  LEFORT_TRY(io::PlanText text, io::read_plan_text(setup_->plan));
  for (std::size_t p = 0; p < parameters_.size(); ++p) parameters_[p].set(text.plan, values[p]);
  if (is_current) {
    prepared_->plan = std::move(text.plan);
  } else {
    release();
    LEFORT_TRY(const fs::path ct, io::scan_of(setup_->plan, text.plan, std::nullopt));
    LEFORT_TRY(prepared_, prepare_case(std::move(text.plan), io::Sha256().add(text.json).hex(), ct,
                                       setup_->cache, progress));
  }
  prepared_values_.assign(values.begin(), values.end());
  if (face_) return {};
  const geometry::TriangleMesh& skin_L = prepared_->skin_L;
  LEFORT_TRY(const std::vector<compare::FaceRegion> region_of, find_regions(*setup_, skin_L));
  const std::vector<double> areas_mm2 = compare::vertex_areas(skin_L);
  Face face{{}, {}, geometry::Bvh(setup_->skin_after_L)};
  for (std::size_t v = 0; v < areas_mm2.size(); ++v) {
    if (region_of[v] == compare::FaceRegion::kElsewhere || areas_mm2[v] == 0.0) continue;
    face.vertices.push_back(v);
    face.area_mm2.push_back(areas_mm2[v]);
  }
  face_ = std::make_shared<const Face>(std::move(face));
  return {};
}

Result<CaseResidual> CalibrationCase::predict(std::span<const double> values, Progress& progress) {
  LEFORT_TRY_VOID(prepare(values, progress));
  progress.begin_stage("solve");
  const io::PlanFile& plan = prepared_->plan;
  LEFORT_TRY(
      const predict::FacePrediction prediction,
      predict::predict_face(prepared_->model, prepared_->paths(),
                            {plan.tissue, plan.boundary, plan.contact, plan.solver}, {}, progress));
  if (!prediction.converged())
    return fail(ErrorCode::kNotConverged,
                fmt::format("{} of {} steps converged, then {}", prediction.steps.size(),
                            prepared_->steps(), prediction.failure->message));
  const auto skin_mm = predict::skin_displacement(
      predict::embed_skin(
          prepared_->skin_L, prepared_->model.tissue,
          predict::embedding_distance_mm(plan.tissue, prepared_->scan_grid.spacing_mm)),
      prediction.steps.back().displacement_mm);
  const compare::SurfaceDifference difference = compare::measure_difference(
      predict::displaced(prepared_->skin_L, skin_mm), face_->achieved_L);
  CaseResidual residual{{}, face_->area_mm2};
  for (const std::size_t v : face_->vertices) residual.signed_mm.push_back(difference.signed_mm[v]);
  return residual;
}

Result<CaseResidual> CalibrationCase::evaluate(std::span<const double> values, Progress& progress) {
  const fs::path file = file_of(values);
  if (auto stored = read_stored(file)) return *std::move(stored);
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the calibration was stopped");
  Result<CaseResidual> residual = predict(values, progress);
  if (!residual && !is_of_case(residual.error())) return residual;
  LEFORT_TRY_VOID(io::make_output_folder(file.parent_path()));
  LEFORT_TRY_VOID(io::write_text(file, stored_text(residual)));
  return residual;
}

double mean_error_mm(const CaseResidual& residual) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t p = 0; p < residual.signed_mm.size(); ++p) {
    if (std::isnan(residual.signed_mm[p])) continue;
    sum += residual.weight[p] * std::abs(residual.signed_mm[p]);
    weights += residual.weight[p];
  }
  return sum / weights;
}

}  // namespace lefort::pipeline
