#include <lefort/core/units.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/pipeline/uncertainty/face_variant.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

namespace lefort::pipeline {
namespace {

/// Poses at the keyframes of all paths.
std::vector<std::vector<RigidTransform>> poses_at_keyframes(
    const std::vector<geometry::RigidPath>& paths) {
  std::set<double> fractions;
  for (const geometry::RigidPath& path : paths)
    for (const geometry::Keyframe& keyframe : path.keyframes)
      fractions.insert(keyframe.path_fraction);
  std::vector<std::vector<RigidTransform>> poses;
  for (const double fraction : fractions) poses.push_back(geometry::poses_at(paths, fraction));
  return poses;
}

/// Moves along the planned paths; the last pose is replaced.
Result<predict::FaceState> solve_from_rest(predict::FaceResponse& response,
                                           const FaceVariant& variant,
                                           const std::vector<RigidTransform>& final_LB,
                                           Progress& progress) {
  predict::FaceState state = response.at_rest();
  for (std::size_t n = 0; n < variant.way_LB.size(); ++n) {
    const bool is_last = n + 1 == variant.way_LB.size();
    LEFORT_TRY(state, response.solve(is_last ? final_LB : variant.way_LB[n], state, progress));
  }
  return state;
}

bool is(const UncertainInput& input, std::string_view parameter) {
  return input.parameter->name == parameter;
}

/// Sets the factor of the penalty, and scales the coefficient of the hardening term with it: it is
/// inversely proportional to the square of the tolerance.
void set_stiffness_factor(predict::PredictionOptions& options, double factor) {
  predict::ContactOptions& contact = options.contact;
  const double ratio = factor / predict::stiffness_factor(contact, options.tissue);
  if (contact.penetration_tolerance_mm) *contact.penetration_tolerance_mm /= std::sqrt(ratio);
  contact.stiffness_factor = factor;
}

predict::PredictionOptions options_of(const FaceVariant& variant,
                                      std::span<const UncertainInput> inputs,
                                      std::span<const double> values) {
  predict::PredictionOptions options = variant.options;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    if (is(inputs[n], "poisson")) options.tissue.poisson = values[n];
    if (is(inputs[n], "skin_ratio_factor") && options.tissue.skin)
      options.tissue.skin->young_mpa *= values[n];
    if (is(inputs[n], "interface_layer_mm")) options.boundary.interface_layer_mm = values[n];
    if (is(inputs[n], "contact_stiffness_factor")) set_stiffness_factor(options, values[n]);
  }
  return options;
}

/// The planned final poses with the execution errors of a sample.
std::vector<RigidTransform> poses_of(const FaceVariant& variant,
                                     std::span<const UncertainInput> inputs,
                                     std::span<const double> values) {
  std::vector<Vec3> shift_mm(variant.planned_LB.size(), Vec3::Zero());
  std::vector<Vec3> turn_rad(variant.planned_LB.size(), Vec3::Zero());
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    if (is(inputs[n], "execution_translation_mm"))
      shift_mm[inputs[n].segment][inputs[n].axis] += values[n];
    if (is(inputs[n], "execution_rotation_deg"))
      turn_rad[inputs[n].segment][inputs[n].axis] += radians_from_degrees(values[n]);
  }
  std::vector<RigidTransform> poses_LB;
  for (std::size_t k = 0; k < shift_mm.size(); ++k) {
    const RigidTransform& planned_LB = variant.planned_LB[k];
    poses_LB.push_back(
        geometry::rigid_motion(shift_mm[k], turn_rad[k], planned_LB * variant.centroids_B[k]) *
        planned_LB);
  }
  return poses_LB;
}

}  // namespace

VariantKey variant_of(std::span<const UncertainInput> inputs, std::span<const double> values) {
  VariantKey key;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    if (is(inputs[n], "elevation_margin_mm")) key.margin_mm = values[n];
    if (is(inputs[n], "bone_threshold_hu")) key.threshold_hu = values[n];
    if (is(inputs[n], "landmark_error_mm")) key.landmark_mm = values[n];
  }
  return key;
}

Result<FaceVariant> make_variant(const PreparedCase& prepared, const predict::TissueOptions& tissue,
                                 const std::optional<double>& margin_mm,
                                 const geometry::TriangleMesh& skin_L, const StageCache& cache,
                                 Progress& progress) {
  const std::vector<geometry::RigidPath> paths = prepared.paths();
  FaceVariant variant{
      .names = {},
      .options = {tissue, prepared.plan.boundary, prepared.plan.contact, prepared.plan.solver},
      .model = {},
      .embedding = {},
      .planned_LB = geometry::poses_at(paths, 1.0),
      .way_LB = poses_at_keyframes(paths),
      .centroids_B = {},
      .nominal = {}};
  if (margin_mm) variant.options.boundary.elevation_margin_mm = margin_mm;
  variant.options.solver.relative_tolerance =
      std::max(variant.options.solver.relative_tolerance, kSampleTolerance);
  for (const geometry::RigidPath& path : paths) variant.names.push_back(path.segment);
  LEFORT_TRY(variant.model,
             remodel_face(prepared, tissue, variant.options.boundary, cache, progress));
  for (const predict::ContactBone& segment : variant.model.segments) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& vertex : segment.surface_B.vertices) sum += vertex;
    variant.centroids_B.push_back(
        sum / double(std::max<std::size_t>(1, segment.surface_B.vertices.size())));
  }
  variant.embedding =
      predict::embed_skin(skin_L, variant.model.tissue,
                          predict::embedding_distance_mm(tissue, prepared.scan_grid.spacing_mm));
  progress.begin_stage("nominal equilibrium");
  LEFORT_TRY(
      const std::unique_ptr<predict::FaceResponse> response,
      predict::FaceResponse::create(variant.model, variant.names, variant.options, progress));
  LEFORT_TRY(variant.nominal, solve_from_rest(*response, variant, variant.planned_LB, progress));
  return variant;
}

Result<SampleSolution> solve_sample(const FaceVariant& variant,
                                    std::span<const UncertainInput> inputs,
                                    std::span<const double> values, StartState start,
                                    Progress& progress) {
  LEFORT_TRY(const std::unique_ptr<predict::FaceResponse> response,
             predict::FaceResponse::create(variant.model, variant.names,
                                           options_of(variant, inputs, values)));
  const std::vector<RigidTransform> poses_LB = poses_of(variant, inputs, values);
  LEFORT_TRY(const predict::FaceState state,
             start == StartState::kNominal
                 ? response->solve(poses_LB, variant.nominal, progress)
                 : solve_from_rest(*response, variant, poses_LB, progress));
  return SampleSolution{predict::skin_displacement(variant.embedding, state.displacement_mm()),
                        response->newton_iterations()};
}

std::vector<Vec3> nominal_skin_mm(const FaceVariant& variant) {
  return predict::skin_displacement(variant.embedding, variant.nominal.displacement_mm());
}

}  // namespace lefort::pipeline
