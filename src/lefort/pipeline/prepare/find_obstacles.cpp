#include <lefort/geometry/rigid_path.h>
#include <lefort/pipeline/prepare/cached_field.h>
#include <lefort/pipeline/prepare/find_obstacles.h>
#include <lefort/predict/contact_field.h>
#include <lefort/predict/regularized_bone.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

namespace lefort::pipeline {
namespace {

// The reach changes in steps of this length, so that most changes of a path keep the obstacles.
constexpr double kMotionStep_mm = 15.0;

/// Bone further than this from the tissue at rest cannot touch it on the path.
double reach_mm(const predict::FaceModel& model, const io::PlanFile& plan,
                const predict::TissueOptions& tissue) {
  double motion_mm = 0.0;
  for (std::size_t k = 0; k < plan.segments.size(); ++k)
    motion_mm = std::max(
        motion_mm, geometry::max_displacement_mm(plan.segments[k].path,
                                                 model.segments[k].surface_B.vertices, 0.0, 1.0));
  return 2.0 * predict::contact_band_mm(tissue) +
         kMotionStep_mm * std::max(std::ceil(motion_mm / kMotionStep_mm), 1.0);
}

Result<void> find_obstacle(predict::ContactBone& bone, const std::string& name,
                           const predict::TissueAtRest& tissue, const io::PlanFile& plan,
                           const predict::RegularizationOptions& options, const StageCache& cache,
                           Progress& progress) {
  progress.begin_stage(name + "'s obstacle");
  Result<predict::RegularizedBone> regularized =
      predict::regularize_bone(bone, tissue, options, progress);
  if (!regularized && regularized.error().code == ErrorCode::kMeshInvalid) {
    progress.note(
        fmt::format("warning: {} is smaller than the mesh resolves: contact reads the "
                    "bone itself",
                    name));
    bone.obstacle = nullptr;
    LEFORT_TRY(bone.field_B,
               find_field(name, bone.surface_B, contact_field_options(plan, bone.surface_B), cache,
                          progress));
    return {};
  }
  if (!regularized) return tl::unexpected(regularized.error());
  progress.note(
      fmt::format("{}: contact reads the bone at the resolution of the mesh, {:.2f} mm "
                  "from the bone (median), {:.2f} mm (P99)",
                  name, regularized->p50_distance_mm, regularized->p99_distance_mm));
  geometry::TriangleMesh surface_B = std::move(regularized->surface_L);
  LEFORT_TRY(auto field_B, find_field(name + "-obstacle", surface_B,
                                      contact_field_options(plan, surface_B), cache, progress));
  bone.obstacle = std::make_shared<const predict::ContactObstacle>(
      predict::ContactObstacle{std::move(surface_B), std::move(field_B),
                               regularized->p50_distance_mm, regularized->p99_distance_mm});
  return {};
}

}  // namespace

Result<void> find_obstacles(predict::FaceModel& model, const io::PlanFile& plan,
                            const predict::TissueOptions& tissue, const StageCache& cache,
                            Progress& progress) {
  if (plan.contact.obstacle == predict::Obstacle::kBone ||
      plan.boundary.interface == predict::TissueInterface::kBonded)
    return {};
  const predict::RegularizationOptions options{.node_spacing_mm = predict::node_spacing_mm(tissue),
                                               .reach_mm = reach_mm(model, plan, tissue)};
  progress.begin_stage("regularize the bones");
  LEFORT_TRY(const predict::TissueAtRest at_rest,
             predict::tissue_at_rest(model.tissue, options, progress));
  for (predict::ContactBone& segment : model.segments)
    LEFORT_TRY_VOID(find_obstacle(segment, "segment", at_rest, plan, options, cache, progress));
  if (model.stationary_bone)
    LEFORT_TRY_VOID(find_obstacle(*model.stationary_bone, "remainder", at_rest, plan, options,
                                  cache, progress));
  return {};
}

}  // namespace lefort::pipeline
