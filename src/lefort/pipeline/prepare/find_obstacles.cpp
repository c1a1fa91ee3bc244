#include <lefort/geometry/rigid_path.h>
#include <lefort/pipeline/prepare/cached_field.h>
#include <lefort/pipeline/prepare/find_obstacles.h>
#include <lefort/predict/contact_field.h>
#include <lefort/predict/load_levels.h>
#include <lefort/predict/regularized_bone.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

// The reach changes in steps of this length, so that most changes of a path keep the obstacles.
constexpr double kMotionStep_mm = 15.0;
constexpr double kAnyMotion_mm = 20.0;  // Largest motion for which obstacles of any motion reach.

/// Largest motion of a vertex of a segment.
double motion_mm(const predict::FaceModel& model, const io::PlanFile& plan, ObstacleMotion motion) {
  if (motion == ObstacleMotion::kAny) return kAnyMotion_mm;
  double max_mm = 0.0;
  for (std::size_t k = 0; k < plan.segments.size(); ++k)
    max_mm = std::max(
        max_mm, geometry::max_displacement_mm(plan.segments[k].path,
                                              model.segments[k].surface_B.vertices, 0.0, 1.0));
  return max_mm;
}

/// Bone further than this from the tissue at rest cannot touch it.
double reach_mm(double motion_mm, const io::PlanFile& plan, const predict::TissueOptions& tissue) {
  return 2.0 * predict::contact_band_mm(tissue, plan.contact.obstacle) +
         kMotionStep_mm * std::max(std::ceil(motion_mm / kMotionStep_mm), 1.0);
}

struct NamedBone {
  std::string name;
  std::string field;  ///< Name in the cache.
  predict::ContactBone* bone;
  const geometry::RigidPath* path = nullptr;  ///< Null: it does not move.
};

RigidTransform pose_of(const NamedBone& bone, double path_fraction) {
  return bone.path ? geometry::pose_at(*bone.path, path_fraction) : RigidTransform::Identity();
}

/// Largest relative motion of two bones on the path, of the points where they adjoin: vertices of
/// one within `near_mm` of the other. Infinite if there are none.
double separation_mm(const NamedBone& one, const NamedBone& other,
                     const std::vector<predict::LoadLevel>& levels, double near_mm) {
  const std::vector<Vec3>& vertices_L = one.bone->surface_B.vertices;
  std::vector<float> distances(vertices_L.size());
  other.bone->field_B->distances(vertices_L, distances);
  std::vector<Vec3> adjoining_L;
  for (std::size_t v = 0; v < vertices_L.size(); ++v)
    if (std::abs(distances[v]) < float(near_mm)) adjoining_L.push_back(vertices_L[v]);
  if (adjoining_L.empty()) return std::numeric_limits<double>::infinity();
  double separation_mm = 0.0;
  for (const predict::LoadLevel& level : levels) {
    const RigidTransform X_one = pose_of(one, level.path_fraction);
    const RigidTransform X_other = pose_of(other, level.path_fraction);
    for (const Vec3& p_L : adjoining_L)
      separation_mm = std::max(separation_mm, (X_one * p_L - X_other * p_L).norm());
  }
  return separation_mm;
}

std::vector<NamedBone> bones_of(predict::FaceModel& model, const io::PlanFile& plan) {
  std::vector<NamedBone> bones;
  for (std::size_t k = 0; k < model.segments.size(); ++k)
    bones.push_back({"segment " + plan.segments[k].osteotomy.segment, "segment", &model.segments[k],
                     &plan.segments[k].path});
  if (model.stationary_bone) bones.push_back({"remainder", "remainder", &*model.stationary_bone});
  return bones;
}

/// The fields of bones that contact reads themselves.
Result<void> find_bone_fields(predict::FaceModel& model, const io::PlanFile& plan,
                              const StageCache& cache, Progress& progress) {
  for (const NamedBone& named : bones_of(model, plan)) {
    LEFORT_TRY(named.bone->field_B,
               find_field(named.field, named.bone->surface_B,
                          contact_field_options(plan, named.bone->surface_B), cache, progress));
  }
  return {};
}

Result<void> find_obstacle(const NamedBone& named, std::span<const predict::AdjacentBone> adjacent,
                           const predict::TissueAtRest& tissue, const io::PlanFile& plan,
                           const predict::RegularizationOptions& options, const StageCache& cache,
                           Progress& progress) {
  predict::ContactBone& bone = *named.bone;
  progress.begin_stage(fmt::format("obstacle of {}", named.name));
  Result<predict::RegularizedBone> regularized =
      predict::regularize_bone(bone, adjacent, tissue, options, progress);
  if (!regularized && regularized.error().code == ErrorCode::kMeshInvalid) {
    progress.note(
        fmt::format("warning: {} is smaller than the mesh resolves: contact reads the "
                    "bone itself",
                    named.name));
    bone.obstacle = nullptr;
    LEFORT_TRY(bone.field_B,
               find_field(named.field, bone.surface_B, contact_field_options(plan, bone.surface_B),
                          cache, progress));
    return {};
  }
  if (!regularized) return tl::unexpected(regularized.error());
  progress.note(
      fmt::format("{}: contact reads the bone at the resolution of the mesh, {:.2f} mm "
                  "from the bone (median), {:.2f} mm (P99)",
                  named.name, regularized->p50_distance_mm, regularized->p99_distance_mm));
  geometry::TriangleMesh surface_B = std::move(regularized->surface_L);
  LEFORT_TRY(auto field_B, find_field(named.field + "-obstacle", surface_B,
                                      contact_field_options(plan, surface_B), cache, progress));
  bone.obstacle = std::make_shared<const predict::ContactObstacle>(
      predict::ContactObstacle{std::move(surface_B), std::move(field_B),
                               regularized->p50_distance_mm, regularized->p99_distance_mm});
  return {};
}

}  // namespace

Result<void> find_obstacles(predict::FaceModel& model, const io::PlanFile& plan,
                            const predict::TissueOptions& tissue,
                            predict::TissueInterface interface, ObstacleMotion motion,
                            const StageCache& cache, Progress& progress) {
  if (plan.contact.obstacle == predict::Obstacle::kBone) return {};
  if (!predict::slides_on_segments(model.tissue, interface) && !model.stationary_bone)
    return find_bone_fields(model, plan, cache, progress);
  const predict::RegularizationOptions options{
      .node_spacing_mm = predict::node_spacing_mm(tissue),
      .reach_mm = reach_mm(motion_mm(model, plan, motion), plan, tissue)};
  progress.begin_stage("regularize the bones");
  LEFORT_TRY(const predict::TissueAtRest at_rest,
             predict::tissue_at_rest(model.tissue, options, progress));
  const std::vector<NamedBone> bones = bones_of(model, plan);
  const std::vector<predict::LoadLevel> levels =
      predict::load_levels(plan::paths_of(plan.segments), 1);
  const auto between_mm = [&](const NamedBone& one, const NamedBone& other) {
    return motion == ObstacleMotion::kAny
               ? std::numeric_limits<double>::infinity()
               : separation_mm(one, other, levels, options.node_spacing_mm);
  };
  for (const NamedBone& named : bones) {
    std::vector<predict::AdjacentBone> adjacent;
    for (const NamedBone& other : bones)
      if (other.bone != named.bone)
        adjacent.push_back({other.bone->field_B,
                            predict::collar_mm(options.node_spacing_mm, between_mm(named, other))});
    LEFORT_TRY_VOID(find_obstacle(named, adjacent, at_rest, plan, options, cache, progress));
  }
  return {};
}

}  // namespace lefort::pipeline
