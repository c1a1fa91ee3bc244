#include <lefort/contact/distance_query.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/predict/release_overlap.h>
#include <lefort/predict/tissue_boundary.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

using Flags = std::vector<char>;

/// The bones of a model at rest: segments, then stationary bone if it has a field.
Result<std::vector<contact::RigidObstacle>> bones_of(const FaceModel& model) {
  std::vector<contact::RigidObstacle> bones;
  const auto add = [&](const ContactBone& bone) -> Result<void> {
    LEFORT_TRY(auto query_B,
               contact::field_distance_query(bone.field_B, contact::DetectionMethod::kTrilinear));
    bones.push_back({.distance_query_B = std::move(query_B)});
    return {};
  };
  for (const ContactBone& segment : model.segments) {
    LEFORT_TRY_VOID(add(segment));
  }
  if (model.stationary_bone) {
    LEFORT_TRY_VOID(add(*model.stationary_bone));
  }
  return bones;
}

/// Depth of a point in a bone, the range of the query if it is deeper; negative outside.
double depth_mm(const contact::RigidObstacle& bone, const Vec3& p_L) {
  const contact::Gap gap = contact::measure_gap(bone, p_L, contact::Derivatives::kFirst);
  const double range_mm = bone.distance_query_B->max_distance_mm();
  return gap.zone == field::Zone::kInside ? range_mm : std::min(-gap.gap_mm, range_mm);
}

/// Whether a node that lies on bone `own` enters another bone.
///
/// \param at_rest    bones at rest.
/// \param poses      of the segments, at each step.
bool enters_other_bone(const Vec3& p_L, std::int32_t own,
                       std::span<const contact::RigidObstacle> at_rest,
                       std::span<const std::vector<RigidTransform>> poses, double contact_snap_mm) {
  for (std::size_t other = 0; other < at_rest.size(); ++other) {
    if (own >= 0 && other == std::size_t(own)) continue;
    const bool is_stationary = other >= poses.front().size();
    if (own == kStationaryBone && is_stationary) continue;
    const double rest_mm = depth_mm(at_rest[other], p_L);
    for (const std::vector<RigidTransform>& X_LB : poses) {
      contact::RigidObstacle bone = at_rest[other];
      if (!is_stationary) bone.X_LB = X_LB[other];
      const Vec3 moved_L = own >= 0 ? Vec3(X_LB[std::size_t(own)] * p_L) : p_L;
      const double deep_mm = depth_mm(bone, moved_L);
      if (deep_mm > contact_snap_mm && deep_mm > rest_mm + contact_snap_mm) return true;
    }
  }
  return false;
}

/// Whether the rule may release a node: it is attached to a bone, not painted, and not in a plane
/// where the mesh ends. Elevated tissue can move away, so bone pushes it.
bool may_release(const NodeInterface& one, const Flags& is_in_plane) {
  const bool is_attached =
      one.condition == InterfaceCondition::kBonded || one.condition == InterfaceCondition::kSliding;
  return is_attached && one.bone != kNoBone && one.rule != InterfaceRule::kPainted &&
         is_in_plane[std::size_t(one.node)] == 0;
}

/// Nodes where the scan or the meshed region ends.
Flags nodes_in_planes(const mesh::VolumeMesh& tissue) {
  Flags flags(tissue.nodes_L.size(), 0);
  for (const char* name : {sets::kCut, sets::kScanBoundary})
    if (const auto set = tissue.node_sets.find(name); set != tissue.node_sets.end())
      for (const std::int32_t node : set->second) flags[std::size_t(node)] = 1;
  return flags;
}

/// Adds the nodes that share an element with a flagged one.
Flags with_neighbors(const mesh::VolumeMesh& tissue, const Flags& flags) {
  Flags all = flags;
  for (const mesh::ElementBlock& block : tissue.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      const std::span of(block.element(e), std::size_t(mesh::node_count(block.shape)));
      const auto is_flagged = [&](std::int32_t node) { return flags[std::size_t(node)] != 0; };
      if (std::any_of(of.begin(), of.end(), is_flagged))
        for (const std::int32_t node : of) all[std::size_t(node)] = 1;
    }
  return all;
}

void remove_from_sets(mesh::VolumeMesh& tissue, const Flags& is_released) {
  const auto is_in = [&](std::int32_t node) { return is_released[std::size_t(node)] != 0; };
  for (const char* name : {sets::kFixed, sets::kBonded})
    if (const auto set = tissue.node_sets.find(name); set != tissue.node_sets.end())
      std::erase_if(set->second, is_in);
  for (const char* name : {sets::kContact, sets::kStationaryContact})
    if (const auto set = tissue.face_sets.find(name); set != tissue.face_sets.end())
      std::erase_if(set->second, [&](const mesh::Face& face) {
        const auto nodes = mesh::nodes_of(face);
        return std::any_of(nodes.begin(), nodes.end(), is_in);
      });
}

}  // namespace

Result<Index> release_overlap(FaceModel& model, std::span<const geometry::RigidPath> paths,
                              double contact_snap_mm) {
  LEFORT_CHECK(paths.size() == model.segments.size());
  LEFORT_TRY(const std::vector<contact::RigidObstacle> at_rest, bones_of(model));
  std::vector<std::vector<RigidTransform>> poses;
  const int steps = geometry::steps_of(paths);
  for (int step = 1; step <= steps; ++step)
    poses.push_back(geometry::poses_at(paths, double(step) / steps));
  std::vector<NodeInterface>& nodes = model.interface.nodes;
  const Flags is_in_plane = nodes_in_planes(model.tissue);
  Flags enters(model.tissue.nodes_L.size(), 0);
  parallel_for(std::ssize(nodes), [&](Index n) {
    const NodeInterface& one = nodes[std::size_t(n)];
    if (!may_release(one, is_in_plane)) return;
    enters[std::size_t(one.node)] = enters_other_bone(model.tissue.nodes_L[std::size_t(one.node)],
                                                      one.bone, at_rest, poses, contact_snap_mm);
  });
  const Flags is_near = with_neighbors(model.tissue, enters);
  Flags is_released(is_near.size(), 0);
  Index count = 0;
  for (NodeInterface& one : nodes) {
    if (is_near[std::size_t(one.node)] == 0 || !may_release(one, is_in_plane)) continue;
    one = {.node = one.node, .rule = InterfaceRule::kOverlap};
    is_released[std::size_t(one.node)] = 1;
    ++count;
  }
  if (count > 0) remove_from_sets(model.tissue, is_released);
  return count;
}

}  // namespace lefort::predict
