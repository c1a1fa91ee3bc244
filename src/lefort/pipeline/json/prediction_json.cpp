#include <lefort/core/units.h>
#include <lefort/core/version.h>
#include <lefort/io/predicted_poses.h>
#include <lefort/pipeline/json/boundary_json.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/json/newton_json.h>
#include <lefort/pipeline/json/prediction_json.h>
#include <lefort/pipeline/timing/peak_memory.h>
#include <lefort/predict/assign_regions.h>
#include <lefort/predict/lip_contact.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using pipeline::as_json;

/// A list with an object for each segment of the plan, in its order: its name, then what
/// `of_segment(k, object)` adds.
template <class Function>
Json segments_json(const io::PlanFile& plan, const Function& of_segment) {
  Json list = Json::array();
  for (std::size_t k = 0; k < plan.segments.size(); ++k) {
    list.push_back({{"name", plan.segments[k].osteotomy.segment}});
    of_segment(k, list.back());
  }
  return list;
}

Json supports_json(const contact::SupportStatistics& supports) {
  return {{"nodes", supports.nodes},
          {"max_slip_mm", supports.max_slip_mm},
          {"max_opening_mm", supports.max_opening_mm},
          {"max_compression_mm", supports.max_compression_mm}};
}

Json lips_json(const predict::FaceModel& model, const std::vector<Vec3>& displacement_mm) {
  if (!model.lips.is_separated()) return nullptr;
  const predict::LipStatistics statistics =
      predict::lip_statistics(model.tissue, model.lips, displacement_mm);
  return {{"max_overlap_mm", statistics.max_overlap_mm},
          {"max_opening_mm", statistics.max_opening_mm},
          {"max_slip_mm", statistics.max_slip_mm},
          {"closed_fraction", statistics.closed_fraction}};
}

Json step_json(const predict::PredictionStep& step, const PreparedCase& prepared) {
  double max_mm = 0.0;
  for (const Vec3& u : step.displacement_mm) max_mm = std::max(max_mm, u.norm());
  Json json{{"path_fraction", step.path_fraction}};
  json["segments"] = segments_json(prepared.plan, [&](std::size_t k, Json& segment) {
    segment["pose_4x4_row_major_mm_lps"] = as_json(step.segments[k].X_LB);
    segment["contact"] = contact_json(step.segments[k].contact);
    segment["supports"] = supports_json(step.segments[k].supports);
  });
  json["contact"] = contact_json(step.contact());
  if (prepared.model.stationary_bone)
    json["stationary_bone_contact"] = contact_json(step.stationary_contact);
  json["stationary_bone_supports"] = supports_json(step.stationary_supports);
  json["lips"] = lips_json(prepared.model, step.displacement_mm);
  json["max_displacement_mm"] = max_mm;
  json["min_volume_ratio"] = step.min_J;
  json["residual_n"] = step.residual_n;
  json["relative_residual"] = step.relative_residual;
  json["attempts"] = attempts_json(step.attempts);
  return json;
}

/// Limits of the penetration increase into all bones, and whether the last step is within them.
Json penetration_limits_json(const predict::FacePrediction& prediction) {
  constexpr contact::PenetrationLimits kLimits;
  Json json{{"p99_mm", kLimits.p99_mm}, {"max_mm", kLimits.max_mm}, {"is_within", nullptr}};
  if (!prediction.steps.empty())
    json["is_within"] = contact::is_within(kLimits, prediction.steps.back().contact_of_all_bones());
  return json;
}

Json overlap_json(const predict::BoneOverlapAtFraction& pair) {
  return {{"path_fraction", pair.path_fraction},
          {"first", pair.first},
          {"second", pair.second},
          {"volume_ml", pair.overlap.volume_mm3 * 1e-3},
          {"max_depth_mm", pair.overlap.deepest_mm},
          {"max_depth_at_mm_lps",
           pair.overlap.overlaps() ? Json(as_json(pair.overlap.deepest_L)) : Json(nullptr)},
          {"depth_is_lower_bound", pair.overlap.depth_is_lower_bound}};
}

Json mucosa_parameters(const predict::TissueOptions& tissue) {
  if (!tissue.mucosa) return nullptr;
  return {{"thickness_mm", tissue.mucosa->thickness_mm},
          {"young_kpa", kpa_from_mpa(tissue.mucosa->young_mpa)},
          {"poisson", tissue.mucosa->poisson}};
}

Json muscle_parameters(const predict::TissueOptions& tissue) {
  if (!tissue.muscle) return nullptr;
  return {{"young_kpa", kpa_from_mpa(tissue.muscle->young_mpa)},
          {"poisson", tissue.muscle->poisson}};
}

Json face_size(const predict::TissueOptions& tissue) {
  if (!tissue.face) return nullptr;
  return tissue.face->element_size_mm;
}

Json skin_parameters(const predict::TissueOptions& tissue) {
  if (!tissue.skin) return nullptr;
  return {{"thickness_mm", tissue.skin->thickness_mm},
          {"layers", tissue.skin->layers},
          {"young_kpa", kpa_from_mpa(tissue.skin->young_mpa)},
          {"poisson", tissue.skin->poisson}};
}

Json parameters(const PreparedCase& prepared, const predict::FacePrediction& prediction) {
  const io::PlanFile& plan = prepared.plan;
  const predict::BoundaryOptions& boundary = plan.boundary;
  return {{"title", plan.title},
          {"steps", prepared.steps()},
          {"bone_hu", plan.segmentation.bone_hu},
          {"skin_hu", plan.segmentation.skin_hu},
          {"law", "neo-Hookean, compressible (Bonet & Wood 6.27)"},
          {"young_kpa", kpa_from_mpa(plan.tissue.young_mpa)},
          {"poisson", plan.tissue.poisson},
          {"skin", skin_parameters(plan.tissue)},
          {"mucosa", mucosa_parameters(plan.tissue)},
          {"muscle", muscle_parameters(plan.tissue)},
          {"lips_and_nose_element_size_mm", face_size(plan.tissue)},
          {"element_size_mm", plan.tissue.element_size_mm},
          {"far_element_size_mm", plan.tissue.far_element_size_mm},
          {"element_order", plan.tissue.element_order},
          {"margin_mm", plan.tissue.margin_mm},
          {"interface", name_of(boundary.interface)},
          {"scan_boundary", name_of(boundary.scan_boundary)},
          {"cut_boundary", name_of(boundary.cut_boundary)},
          {"foundation_mm", boundary.foundation_mm},
          {"elevation_margin_mm",
           boundary.elevation_margin_mm ? Json(*boundary.elevation_margin_mm) : Json(nullptr)},
          {"joint_margin_mm", boundary.joint_margin_mm},
          {"vestibule_mm", boundary.vestibule_mm},
          {"lip_tone_kpa", 1000.0 * boundary.lip_tone_mpa},
          {"interface_layer_mm", boundary.interface_layer_mm},
          {"contact_snap_mm", plan.boundary.contact_snap_mm},
          {"stiffness_factor", predict::stiffness_factor(plan.contact, plan.tissue)},
          {"contact_stiffness_mpa_per_mm", prediction.contact_stiffness_mpa_per_mm},
          {"obstacle", predict::name_of(plan.contact.obstacle)},
          {"detection", contact::name_of(plan.contact.detection)},
          {"integration", contact::name_of(plan.contact.integration)},
          {"penetration_tolerance_mm", plan.contact.penetration_tolerance_mm
                                           ? Json(*plan.contact.penetration_tolerance_mm)
                                           : Json(nullptr)},
          {"relative_tolerance", plan.solver.relative_tolerance},
          {"max_iterations", plan.solver.max_iterations},
          {"min_increment_ratio", plan.solver.min_increment_ratio}};
}

Json volumes(const PreparedCase& prepared) {
  Json json = Json::object();
  for (const auto& [name, ml] : prepared.tissue_volumes_ml) json[name] = ml;
  return json;
}

Json as_json(const mesh::QualitySummary& quality) {
  return {{"elements", quality.elements},
          {"volume_ml", quality.volume_mm3 * 1e-3},
          {"min_scaled_jacobian", quality.min_scaled_jacobian},
          {"mean_scaled_jacobian", quality.mean_scaled_jacobian},
          {"min_dihedral_deg", quality.min_dihedral_deg},
          {"max_dihedral_deg", quality.max_dihedral_deg},
          {"scaled_jacobian_histogram", quality.jacobian_histogram},
          {"dihedral_histogram", quality.dihedral_histogram}};
}

Json as_json(const std::optional<mesh::LayerThickness>& skin) {
  if (!skin) return nullptr;
  Json thin = Json::array();
  for (const mesh::ThinPatch& patch : skin->thin)
    thin.push_back({{"area_mm2", patch.area_mm2}, {"center_mm_lps", as_json(patch.center_L)}});
  return {{"area_mm2", skin->area_mm2},
          {"covered_fraction", skin->covered_fraction},
          {"mean_thickness_mm", skin->mean_mm},
          {"p05_thickness_mm", skin->p05_mm},
          {"full_thickness_fraction", skin->full_thickness_fraction},
          {"thin_patches", thin}};
}

Json regions_summary(const PreparedCase& prepared) {
  Json regions = Json::object();
  for (const auto& [name, size] :
       predict::regions_and_sizes(prepared.model.tissue, prepared.plan.tissue))
    regions[name] = {{"elements", size.elements}, {"volume_ml", size.volume_mm3 * 1e-3}};
  return regions;
}

Json mesh_summary(const PreparedCase& prepared) {
  const mesh::VolumeMesh& tissue = prepared.model.tissue;
  Json by_shape = Json::object();
  for (const auto& [shape, quality] : prepared.quality.by_shape)
    by_shape[std::string(mesh::name_of(shape))] = as_json(quality);
  Json sets = Json::object();
  for (const auto& [name, nodes] : tissue.node_sets) sets[name] = nodes.size();
  return {{"nodes", tissue.node_count()},
          {"elements", tissue.element_count()},
          {"volume_ml", prepared.quality.volume_mm3 * 1e-3},
          {"min_dihedral_deg", prepared.quality.min_dihedral_deg},
          {"min_scaled_jacobian", prepared.quality.min_scaled_jacobian},
          {"by_shape", by_shape},
          {"regions", regions_summary(prepared)},
          {"skin", as_json(prepared.skin_layer)},
          {"inverted_elements", prepared.quality.inverted.size()},
          {"contact_faces", tissue.face_sets.at("contact").size()},
          {"node_sets", sets},
          {"boundary", boundary_json(prepared)}};
}

Json field_summary(const field::DistanceField& field) {
  return {{"resolution", field.frame().resolution},
          {"cell_mm", field.cell_mm()},
          {"band_mm", field.band_mm()},
          {"sample_bytes", field.sample_bytes()},
          {"smooth_bytes", field.smooth_bytes()}};
}

/// Null if contact reads the bone itself.
Json obstacle_summary(const std::shared_ptr<const predict::ContactObstacle>& obstacle) {
  if (!obstacle) return nullptr;
  return {{"p50_distance_mm", obstacle->p50_distance_mm},
          {"p99_distance_mm", obstacle->p99_distance_mm}};
}

Json bones_summary(const PreparedCase& prepared) {
  const std::optional<predict::ContactBone>& remainder = prepared.model.stationary_bone;
  return {{"skull_volume_ml", prepared.cut.skull_volume_mm3 * 1e-3},
          {"remainder_volume_ml", prepared.cut.remainder_volume_mm3 * 1e-3},
          {"remainder_obstacle", obstacle_summary(remainder ? remainder->obstacle : nullptr)}};
}

Json segments_summary(const PreparedCase& prepared) {
  const plan::CutSegments& cut = prepared.cut;
  return segments_json(prepared.plan, [&](std::size_t k, Json& segment) {
    const plan::OsteotomyOptions& options = prepared.plan.segments[k].cut;
    segment["volume_ml"] = cut.volumes_mm3[k] * 1e-3;
    segment["pieces"] = cut.cuts[k].segment_pieces;
    segment["fragments"] = as_json(cut.cuts[k].fragments);
    segment["triangles"] = cut.segments_L[k].triangle_count();
    segment["min_piece_ml"] = options.min_piece_ml;
    segment["min_piece_fraction"] = options.min_piece_fraction;
    segment["field"] = field_summary(*prepared.model.segments[k].field_B);
    segment["obstacle"] = obstacle_summary(prepared.model.segments[k].obstacle);
  });
}

}  // namespace

Json timing_json(const Timing& timing) {
  Json stages = Json::object();
  double total = 0.0;
  for (const auto& [name, seconds] : timing.stage_seconds) {
    stages[name] = stages.value(name, 0.0) + seconds;
    total += seconds;
  }
  return {{"total_seconds", total},
          {"stage_seconds", stages},
          {"step_seconds", timing.step_seconds},
          {"peak_memory_mb", peak_memory_mb()}};
}

Json prediction_json(const PreparedCase& prepared, const predict::FacePrediction& prediction,
                     const predict::SkinDisplacementStatistics& skin,
                     const std::optional<Timing>& timing) {
  Json steps = Json::array();
  for (const predict::PredictionStep& step : prediction.steps)
    steps.push_back(step_json(step, prepared));
  Json overlaps = Json::array();
  for (const predict::BoneOverlapAtFraction& pair : prepared.overlaps)
    overlaps.push_back(overlap_json(pair));
  Json plan_files = Json::array();
  for (const auto& [name, sha256] : prepared.provenance.plan_files)
    plan_files.push_back({{"file", name}, {"sha256", sha256}});
  Json json{
      {"lefort_prediction", io::kPredictionVersion},
      {"notice", kNotForClinicalUse},
      {"version", kVersion},
      {"converged", prediction.converged()},
      {"inputs",
       {{"plan_sha256", prepared.provenance.plan_sha256},
        {"plan_files", plan_files},
        {"ct_sha256", prepared.provenance.ct_sha256},
        {"ct_kind", prepared.provenance.ct_kind},
        {"labels_sha256", prepared.provenance.labels_sha256},
        {"labels_source", prepared.provenance.labels_source},
        {"warnings", prepared.provenance.warnings}}},
      {"parameters", parameters(prepared, prediction)},
      {"tissue_volumes_ml", volumes(prepared)},
      {"bones", bones_summary(prepared)},
      {"segments", segments_summary(prepared)},
      {"mesh", mesh_summary(prepared)},
      {"bone_overlap", overlaps},
      {"rest_penetration_mm", prediction.rest_penetration_mm},
      {"penetration_limits", penetration_limits_json(prediction)},
      {"skin",
       {{"max_shift_mm", skin.max_mm}, {"mean_shift_where_moved_mm", skin.mean_over_moved_mm}}},
      {"steps", steps}};
  if (prepared.teeth) {
    Json& teeth = json["inputs"]["teeth"];
    teeth = {{"source", io::name_of(prepared.plan.teeth_source)}, {"numbers", Json::array()}};
    for (const predict::JawTooth& tooth : prepared.teeth->teeth)
      teeth["numbers"].push_back(tooth.fdi);
  }
  if (!prediction.converged()) {
    json["failure"] = prediction.failure->message;
    json["failed_attempts"] = attempts_json(prediction.failed_attempts);
  }
  if (timing) json["timing"] = timing_json(*timing);
  return json;
}

}  // namespace lefort::pipeline
