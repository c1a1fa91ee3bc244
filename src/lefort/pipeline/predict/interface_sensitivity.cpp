#include <lefort/pipeline/predict/interface_sensitivity.h>
#include <lefort/pipeline/prepare/coarse_face.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/load_levels.h>
#include <lefort/predict/predict_face.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lefort::pipeline {
namespace {

constexpr double kMoved_mm = 0.5;  ///< As in the summary of a prediction.

/// The paths in as few steps as the coarse mesh allows (predict/load_levels.h).
std::vector<geometry::RigidPath> in_coarse_steps(const PreparedCase& prepared,
                                                 double element_size_mm) {
  std::vector<geometry::RigidPath> paths = prepared.paths();
  double moved_mm = 0.0;
  for (std::size_t k = 0; k < paths.size(); ++k)
    moved_mm =
        std::max(moved_mm, geometry::max_displacement_mm(
                               paths[k], prepared.model.segments[k].surface_B.vertices, 0.0, 1.0));
  const double step_mm =
      predict::increment_element_fraction(prepared.plan.contact.obstacle) * element_size_mm;
  const int steps = std::max(1, int(std::ceil(moved_mm / step_mm)));
  for (geometry::RigidPath& path : paths) path.steps = steps;
  return paths;
}

/// Displacement of the skin by one interface, on a coarse mesh for both: only their difference is
/// reported. Contact as a random input: \cite knoops2018.
Result<std::vector<Vec3>> solve(const PreparedCase& prepared, predict::TissueInterface interface,
                                const StageCache& cache, Progress& progress) {
  const predict::TissueOptions tissue = coarse_tissue(prepared.plan.tissue);
  predict::BoundaryOptions boundary = prepared.plan.boundary;
  boundary.interface = interface;
  LEFORT_TRY(const predict::FaceModel model,
             remodel_face(prepared, tissue, boundary, cache, progress));
  progress.begin_stage(fmt::format("sensitivity: {} interface", name_of(interface)));
  LEFORT_TRY(const predict::FacePrediction prediction,
             predict::predict_face(model, in_coarse_steps(prepared, tissue.element_size_mm),
                                   {tissue, boundary, prepared.plan.contact, prepared.plan.solver},
                                   {}, progress));
  if (prediction.failure) return tl::unexpected(*prediction.failure);
  return predict::skin_displacement(
      predict::embed_skin(prepared.skin_L, model.tissue,
                          predict::embedding_distance_mm(tissue, prepared.scan_grid.spacing_mm)),
      prediction.steps.back().displacement_mm);
}

/// \param sorted  ascending, not empty.
double percentile(const std::vector<double>& sorted, double fraction) {
  return sorted[std::size_t(std::floor(fraction * double(sorted.size() - 1)))];
}

}  // namespace

Result<InterfaceSensitivity> measure_interface_sensitivity(const PreparedCase& prepared,
                                                           const StageCache& cache,
                                                           Progress& progress) {
  InterfaceSensitivity sensitivity{.element_size_mm =
                                       coarse_tissue(prepared.plan.tissue).element_size_mm};
  Result<std::vector<Vec3>> attached_mm = solve(prepared, sensitivity.attached, cache, progress);
  const auto may_help = [](ErrorCode code) {
    return code != ErrorCode::kCancelled && code != ErrorCode::kOutOfMemory;
  };
  if (!attached_mm && may_help(attached_mm.error().code)) {
    sensitivity.attached = predict::TissueInterface::kClinical;
    attached_mm = solve(prepared, sensitivity.attached, cache, progress);
  }
  Result<std::vector<Vec3>> pushed_mm =
      attached_mm ? solve(prepared, predict::TissueInterface::kContact, cache, progress)
                  : attached_mm;
  if (!pushed_mm) {
    if (pushed_mm.error().code == ErrorCode::kCancelled) return tl::unexpected(pushed_mm.error());
    sensitivity.failure = fmt::format(
        "{} interface: {}",
        name_of(attached_mm ? predict::TissueInterface::kContact : sensitivity.attached),
        pushed_mm.error().message);
    return sensitivity;
  }
  std::vector<double> distances_mm;
  for (std::size_t v = 0; v < attached_mm->size(); ++v)
    if (std::max((*attached_mm)[v].norm(), (*pushed_mm)[v].norm()) > kMoved_mm)
      distances_mm.push_back(((*attached_mm)[v] - (*pushed_mm)[v]).norm());
  sensitivity.attached_mm = *std::move(attached_mm);
  sensitivity.contact_mm = *std::move(pushed_mm);
  if (distances_mm.empty()) return sensitivity;
  std::sort(distances_mm.begin(), distances_mm.end());
  sensitivity.p50_mm = percentile(distances_mm, 0.50);
  sensitivity.p90_mm = percentile(distances_mm, 0.90);
  sensitivity.p99_mm = percentile(distances_mm, 0.99);
  sensitivity.max_mm = distances_mm.back();
  return sensitivity;
}

nlohmann::ordered_json as_json(const InterfaceSensitivity& sensitivity) {
  using Json = nlohmann::ordered_json;
  Json json{{"interfaces", {name_of(sensitivity.attached), "contact"}},
            {"element_size_mm", sensitivity.element_size_mm}};
  json["difference_mm"] = sensitivity.failure ? Json(nullptr)
                                              : Json{{"p50", sensitivity.p50_mm},
                                                     {"p90", sensitivity.p90_mm},
                                                     {"p99", sensitivity.p99_mm},
                                                     {"max", sensitivity.max_mm}};
  json["failure"] = sensitivity.failure ? Json(*sensitivity.failure) : Json(nullptr);
  return json;
}

report::ReportTable as_table(const InterfaceSensitivity& sensitivity) {
  return {"Uncertainty by the interface of tissue and bone",
          {"quantity", "value"},
          {{fmt::format("{} versus contact interface, elements of {:g} mm: distance of the two "
                        "faces where the skin moves",
                        name_of(sensitivity.attached), sensitivity.element_size_mm),
            in_words(sensitivity)}}};
}

std::string in_words(const InterfaceSensitivity& sensitivity) {
  if (sensitivity.failure) return "unknown: " + *sensitivity.failure;
  return fmt::format("P50 {:.1f} mm, P90 {:.1f} mm, P99 {:.1f} mm", sensitivity.p50_mm,
                     sensitivity.p90_mm, sensitivity.p99_mm);
}

}  // namespace lefort::pipeline
