#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/predict/distance_to_label.h>
#include <lefort/predict/interface_map.h>
#include <lefort/predict/oral_vestibule.h>
#include <lefort/predict/separate_lips.h>
#include <lefort/predict/skin_faces.h>
#include <lefort/predict/tissue_boundary.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace lefort::predict {
namespace {

constexpr double kFar_mm = std::numeric_limits<double>::infinity();
/// Sliding tissue this close to air may separate from its bone: two voxels of a clinical scan.
constexpr double kNearAir_mm = 2.0;

/// A bone this close to a plane crosses it: two voxels, because surfaces end inside the scan.
constexpr double kCrosses_mm = 2.0;

/// A point of bone this close to a cut face lies at it: the width of a saw cut.
constexpr double kAtCut_mm = 2.0;

/// A voxel of bone is this close to a node on bone.
constexpr double kNearBone_mm = 4.0;

/// Distance to a surface, infinite if it is empty or further than `within_mm`.
double distance_mm(const geometry::Bvh* surface, const Vec3& p_L, double within_mm = kFar_mm) {
  if (surface == nullptr) return kFar_mm;
  const auto closest = surface->closest_point(p_L, within_mm);
  return closest ? closest->distance_mm : kFar_mm;
}

std::unique_ptr<const geometry::Bvh> tree_of(const geometry::TriangleMesh& surface_L) {
  if (surface_L.triangles.empty()) return nullptr;
  return std::make_unique<const geometry::Bvh>(surface_L);
}

/// The set of a boundary node (tissue_boundary.h).
enum class BoundarySet : std::uint8_t { kCut, kScan, kSegment, kStationary, kBrain, kSkin, kRest };

std::vector<BoundarySet> sets_of_nodes(const mesh::VolumeMesh& tissue) {
  std::vector<BoundarySet> set_of(tissue.nodes_L.size(), BoundarySet::kRest);
  const std::array<std::pair<const char*, BoundarySet>, 6> known{
      {{sets::kCut, BoundarySet::kCut},
       {sets::kScanBoundary, BoundarySet::kScan},
       {sets::kMobilizedSegment, BoundarySet::kSegment},
       {sets::kStationaryBone, BoundarySet::kStationary},
       {sets::kBrain, BoundarySet::kBrain},
       {sets::kSkin, BoundarySet::kSkin}}};
  for (const auto& [name, set] : known)
    for (const std::int32_t node : tissue.node_sets.at(name)) set_of[std::size_t(node)] = set;
  return set_of;
}

InterfaceCondition condition_of(OuterBoundary boundary) {
  switch (boundary) {
    case OuterBoundary::kFree:
      return InterfaceCondition::kFree;
    case OuterBoundary::kFixed:
      return InterfaceCondition::kFixed;
    case OuterBoundary::kFoundation:
      return InterfaceCondition::kFoundation;
    default:
      return InterfaceCondition::kRoller;
  }
}

/// The rules, and what they measure. Tissue is bonded to bone and slides on teeth (\cite kim2017);
/// teeth lie within the height of their crowns of the opposite jaw (\cite magne2003).
class InterfaceRules {
 public:
  InterfaceRules(const anatomy::LabelMap& labels, const InterfaceBones& bones,
                 const BoundaryOptions& options)
      : labels_(labels),
        options_(options),
        zones_(bones.elevation),
        teeth_(is_clinical() ? bones.teeth : nullptr) {
    for (const geometry::TriangleMesh& segment_L : bones.segments_L)
      segments_.push_back(tree_of(segment_L));
    remainder_ = tree_of(bones.remainder_L);
    for (const plan::ElevationZone& zone : zones_) cuts_.push_back(tree_of(zone.cut_faces_L));
    if (is_clinical() && options_.vestibule_mm > 0.0)
      vestibule_ = find_oral_vestibule(labels_, options_.vestibule_mm, teeth_);
  }

  /// Condition by rule of a node at `p_L`.
  [[nodiscard]] NodeInterface by_rule(const Vec3& p_L, BoundarySet set) const {
    if (set == BoundarySet::kCut || set == BoundarySet::kScan) return outer(p_L, set);
    if (set == BoundarySet::kSegment) return on_segment(p_L, closest_segment(p_L).first);
    if (set == BoundarySet::kStationary) return on_stationary(p_L, InterfaceRule::kStationary);
    if (set == BoundarySet::kBrain) return on_stationary(p_L, InterfaceRule::kBrain);
    if (set == BoundarySet::kSkin)
      return {.condition = InterfaceCondition::kFree, .rule = InterfaceRule::kSkin};
    return {.condition = pushed(), .rule = InterfaceRule::kAir};
  }

  /// The plane at a node, with the motion of a segment that crosses it. The fraction is the weight
  /// of that segment against the stationary bone, by inverse squared distance (\cite shepard1968).
  [[nodiscard]] NodePlane plane_at(const Vec3& p_L, const Vec3& normal_L) const {
    NodePlane plane{.normal_L = normal_L};
    double nearest_mm = kFar_mm;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      if (!crosses(segments_[k].get(), p_L, normal_L)) continue;
      const double mm = distance_mm(segments_[k].get(), p_L);
      if (mm >= nearest_mm) continue;
      nearest_mm = mm;
      plane.segment = std::int32_t(k);
    }
    if (plane.segment == kStationaryBone) return plane;
    const double other_mm = distance_mm(remainder_.get(), p_L);
    const double ratio = nearest_mm / other_mm;  // 0 without stationary bone.
    plane.motion_fraction = 1.0 / (1.0 + ratio * ratio);
    return plane;
  }

  /// Condition by a painted label.
  [[nodiscard]] NodeInterface painted(const Vec3& p_L, BoundaryLabel label) const {
    NodeInterface node{.rule = InterfaceRule::kPainted};
    const auto [segment, segment_mm] = closest_segment(p_L);
    const bool is_on_segment = segment_mm <= distance_mm(remainder_.get(), p_L, segment_mm);
    const std::int32_t bone = is_on_segment ? segment : kStationaryBone;
    switch (label) {
      case BoundaryLabel::kFixed:
        node.condition = InterfaceCondition::kFixed;
        return node;
      case BoundaryLabel::kWithSegment:
        node.condition = InterfaceCondition::kBonded;
        node.bone = segment;
        return node;
      case BoundaryLabel::kBonded:
        node.condition = InterfaceCondition::kBonded;
        node.bone = bone;
        return node;
      case BoundaryLabel::kElevated:
        node.condition = InterfaceCondition::kElevated;
        node.bone = bone;
        return node;
      case BoundaryLabel::kSliding:
        node.condition = InterfaceCondition::kSliding;
        node.bone = bone;
        node.may_separate = is_near_air(p_L);
        return node;
      default:  // Free, or contact with all bones (face sets of tissue_boundary.h).
        node.condition = InterfaceCondition::kContact;
        return node;
    }
  }

  [[nodiscard]] bool is_near_air(const Vec3& p_L) const {
    return distance_to_label(labels_, anatomy::Tissue::kAirway, p_L, kNearAir_mm) <= kNearAir_mm;
  }

 private:
  /// Whether a surface reaches the plane through `p_L`.
  [[nodiscard]] static bool crosses(const geometry::Bvh* surface, const Vec3& p_L,
                                    const Vec3& normal_L) {
    if (surface == nullptr) return false;
    return std::any_of(
        surface->mesh().vertices.begin(), surface->mesh().vertices.end(),
        [&](const Vec3& vertex_L) { return normal_L.dot(vertex_L - p_L) <= kCrosses_mm; });
  }

  [[nodiscard]] bool is_clinical() const {
    return options_.interface == TissueInterface::kClinical;
  }
  /// Inner surface that no bone holds.
  [[nodiscard]] InterfaceCondition pushed() const { return InterfaceCondition::kContact; }

  [[nodiscard]] std::pair<std::int32_t, double> closest_segment(const Vec3& p_L) const {
    std::pair<std::int32_t, double> best{0, kFar_mm};
    for (std::size_t k = 0; k < segments_.size(); ++k)
      if (const double mm = distance_mm(segments_[k].get(), p_L); mm < best.second)
        best = {std::int32_t(k), mm};
    return best;
  }

  /// Whether an osteotomy elevates tissue at a point of `bone`.
  [[nodiscard]] bool is_elevated(const Vec3& p_L, std::int32_t bone) const {
    for (std::size_t k = 0; k < zones_.size(); ++k) {
      const plan::ElevationMargins& margins = zones_[k].margins;
      const double margin_mm = bone == std::int32_t(k) ? margins.segment_mm : margins.other_side_mm;
      if (distance_mm(cuts_[k].get(), p_L, margin_mm) < margin_mm) return true;
    }
    return false;
  }

  /// Whether a point of a bone lies at a cut face.
  [[nodiscard]] bool is_at_cut(const Vec3& p_L) const {
    return std::any_of(cuts_.begin(), cuts_.end(), [&](const auto& cut) {
      return distance_mm(cut.get(), p_L, kAtCut_mm) <= kAtCut_mm;
    });
  }

  /// Whether `other` is near, and no osteotomy separates it from the bone at `p_L`: its closest
  /// point is not at a cut face. Crowns form pairs with crowns only, where tissue slides anyway.
  [[nodiscard]] bool is_joint_with(const geometry::Bvh* other, const Vec3& p_L) const {
    if (other == nullptr) return false;
    const auto closest = other->closest_point(p_L, options_.joint_margin_mm);
    return closest && closest->distance_mm < options_.joint_margin_mm &&
           !is_at_cut(closest->point) && !is_on_crown(closest->point);
  }

  [[nodiscard]] bool is_on_crown(const Vec3& p_L) const {
    return teeth_ != nullptr && teeth_->is_on_crown(p_L);
  }

  /// Whether bone that moves relative to `bone` is near, and no osteotomy separates them.
  [[nodiscard]] bool is_in_joint(const Vec3& p_L, std::int32_t bone) const {
    if (bone != kStationaryBone && is_joint_with(remainder_.get(), p_L)) return true;
    for (std::size_t k = 0; k < segments_.size(); ++k)
      if (bone != std::int32_t(k) && is_joint_with(segments_[k].get(), p_L)) return true;
    return false;
  }

  /// Whether a point of bone lies on teeth or gingiva.
  [[nodiscard]] bool is_in_vestibule(const Vec3& p_L) const {
    if (!vestibule_) return false;
    const bool in_upper = vestibule_->contains(p_L, false);
    const bool in_lower = vestibule_->contains(p_L, true);
    if (in_upper == in_lower) return in_upper;
    const double upper_mm = distance_to_label(labels_, anatomy::Tissue::kBone, p_L, kNearBone_mm);
    const double lower_mm =
        distance_to_label(labels_, anatomy::Tissue::kMandible, p_L, kNearBone_mm);
    if (upper_mm == kFar_mm && lower_mm == kFar_mm) return false;
    return lower_mm < upper_mm ? in_lower : in_upper;
  }

  [[nodiscard]] NodeInterface on_segment(const Vec3& p_L, std::int32_t segment) const {
    if (is_clinical()) return on_bone(p_L, segment, InterfaceRule::kSegment);
    const bool is_bonded = options_.interface == TissueInterface::kBonded;
    return {.condition = is_bonded ? InterfaceCondition::kBonded : InterfaceCondition::kContact,
            .rule = InterfaceRule::kSegment,
            .bone = segment};
  }

  [[nodiscard]] NodeInterface on_stationary(const Vec3& p_L, InterfaceRule rule) const {
    if (is_clinical()) return on_bone(p_L, kStationaryBone, rule);
    const double margin_mm = options_.elevation_margin_mm.value_or(kElevationMargin_mm);
    if (closest_segment(p_L).second < margin_mm)
      return {.condition = pushed(), .rule = InterfaceRule::kOsteotomy};
    return {.condition = InterfaceCondition::kBonded, .rule = rule, .bone = kStationaryBone};
  }

  [[nodiscard]] NodeInterface on_bone(const Vec3& p_L, std::int32_t bone,
                                      InterfaceRule rule) const {
    NodeInterface node{.condition = InterfaceCondition::kBonded, .rule = rule, .bone = bone};
    if (is_on_crown(p_L)) {  // No periosteum, also near a cut.
      node.condition = InterfaceCondition::kSliding;
      node.rule = InterfaceRule::kCrown;
      node.may_separate = is_near_air(p_L);  // Elsewhere the tone of the lips holds them on teeth.
    } else if (is_elevated(p_L, bone)) {
      node.condition = InterfaceCondition::kElevated;
      node.rule = InterfaceRule::kOsteotomy;
    } else if (is_in_vestibule(p_L)) {
      node.condition = InterfaceCondition::kSliding;
      node.rule = InterfaceRule::kVestibule;
      node.may_separate = is_near_air(p_L);  // As on crowns.
    } else if (is_in_joint(p_L, bone)) {
      node.condition = InterfaceCondition::kSliding;
      node.rule = InterfaceRule::kJoint;
      node.may_separate = is_near_air(p_L);
    }
    return node;
  }

  /// Where the mesh ends. kClinical: bone that the plane crosses holds its tissue there, too.
  [[nodiscard]] NodeInterface outer(const Vec3& p_L, BoundarySet set) const {
    const bool is_cut = set == BoundarySet::kCut;
    if (is_clinical()) {
      const double snap_mm = options_.contact_snap_mm;
      const auto [segment, mm] = closest_segment(p_L);
      if (mm <= snap_mm) return on_segment(p_L, segment);
      if (distance_mm(remainder_.get(), p_L, snap_mm) <= snap_mm)
        return on_stationary(p_L, InterfaceRule::kStationary);
    }
    return {.condition = condition_of(is_cut ? options_.cut_boundary : options_.scan_boundary),
            .rule = is_cut ? InterfaceRule::kCutBoundary : InterfaceRule::kScanBoundary};
  }

  const anatomy::LabelMap& labels_;
  const BoundaryOptions& options_;
  std::span<const plan::ElevationZone> zones_;
  const JawTeeth* teeth_;
  std::vector<std::unique_ptr<const geometry::Bvh>> segments_, cuts_;
  std::unique_ptr<const geometry::Bvh> remainder_;
  std::optional<OralVestibule> vestibule_;
};

}  // namespace

const InterfaceConditionStyle& style_of(InterfaceCondition condition) {
  for (const InterfaceConditionStyle& style : kInterfaceConditions)
    if (style.condition == condition) return style;
  LEFORT_CHECK(false);
  return kInterfaceConditions.front();
}

const InterfaceRuleStyle& style_of(InterfaceRule rule) {
  for (const InterfaceRuleStyle& style : kInterfaceRules)
    if (style.rule == rule) return style;
  LEFORT_CHECK(false);
  return kInterfaceRules.front();
}

namespace {

/// Nodes where the lips touch: air reaches them between the lips.
std::vector<char> nodes_of_lips(const mesh::VolumeMesh& tissue) {
  std::vector<char> is_on_lip(tissue.nodes_L.size(), 0);
  for (const char* name : {sets::kUpperLip, sets::kLowerLip})
    if (const auto set = tissue.node_sets.find(name); set != tissue.node_sets.end())
      for (const std::int32_t node : set->second) is_on_lip[std::size_t(node)] = 1;
  return is_on_lip;
}

/// Whether the mesh ends at a node, in a plane.
bool is_in_plane(const NodeInterface& node) {
  return node.condition == InterfaceCondition::kRoller ||
         node.condition == InterfaceCondition::kFoundation;
}

/// Gives mid-edge nodes of the boundary the condition of both corners, if these have the same
/// condition on the same bone. Otherwise, and in planes, the rule decides at the position of the
/// node. Paint is kept.
void join_middle_nodes(std::vector<NodeInterface>& nodes, const mesh::VolumeMesh& tissue) {
  std::vector<std::int32_t> place(tissue.nodes_L.size(), -1);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    place[std::size_t(nodes[n].node)] = std::int32_t(n);
  const auto at = [&](std::int32_t node) -> NodeInterface& {
    return nodes[std::size_t(place[std::size_t(node)])];
  };
  for (const mesh::Face& face : tissue.face_sets.at("boundary")) {
    if (face.shape != mesh::FaceShape::kTri6) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      NodeInterface& middle = at(face.nodes[3 + i]);
      const NodeInterface &a = at(face.nodes[i]), &b = at(face.nodes[(i + 1) % 3]);
      if (is_in_plane(a) || is_in_plane(middle)) continue;
      if (middle.rule == InterfaceRule::kPainted) continue;
      if (a.condition != b.condition || a.bone != b.bone) continue;
      middle = {.node = middle.node,
                .condition = a.condition,
                .rule = a.rule,
                .bone = a.bone,
                .may_separate = a.may_separate && b.may_separate};
    }
  }
}

/// Lets tissue slide where an element joins nodes that are bonded to two bones. Tissue cannot be
/// bonded to two bones that move relative to each other, and the motion of the bones alone would
/// invert such an element.
template <class IsNearAir>
void release_nodes_between_bones(std::vector<NodeInterface>& nodes, const mesh::VolumeMesh& tissue,
                                 const std::vector<char>& is_on_lip, const IsNearAir& is_near_air) {
  std::vector<std::int32_t> bone_of(tissue.nodes_L.size(), kNoBone);
  for (const NodeInterface& one : nodes)
    if (one.condition == InterfaceCondition::kBonded && one.rule != InterfaceRule::kBrain)
      bone_of[std::size_t(one.node)] = one.bone;
  std::vector<char> is_between(tissue.nodes_L.size(), 0);
  for (const mesh::ElementBlock& block : tissue.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      const std::span of(block.element(e), std::size_t(mesh::node_count(block.shape)));
      std::int32_t first = kNoBone;
      bool has_two = false;
      for (const std::int32_t node : of) {
        const std::int32_t bone = bone_of[std::size_t(node)];
        if (bone == kNoBone) continue;
        if (first == kNoBone) first = bone;
        has_two |= bone != first;
      }
      if (!has_two) continue;
      for (const std::int32_t node : of)
        if (bone_of[std::size_t(node)] != kNoBone) is_between[std::size_t(node)] = 1;
    }
  for (NodeInterface& one : nodes)
    if (is_between[std::size_t(one.node)] != 0 && one.rule != InterfaceRule::kPainted) {
      one.condition = InterfaceCondition::kSliding;
      one.rule = InterfaceRule::kJoint;
      one.may_separate = is_on_lip[std::size_t(one.node)] != 0 ||
                         is_near_air(tissue.nodes_L[std::size_t(one.node)]);
    }
}

}  // namespace

InterfaceMap make_interface_map(const mesh::VolumeMesh& tissue, const TissueDomain& domain,
                                const anatomy::LabelMap& labels, const InterfaceBones& bones,
                                const BoundaryOptions& options, const BoundaryLabelMap* painted) {
  const InterfaceRules rules(labels, bones, options);
  const std::vector<std::int32_t>& boundary = tissue.node_sets.at("boundary");
  const std::vector<BoundarySet> set_of = sets_of_nodes(tissue);
  const std::vector<char> is_on_lip = nodes_of_lips(tissue);
  InterfaceMap map;
  map.nodes.resize(boundary.size());
  parallel_for(std::ssize(boundary), [&](Index n) {
    const std::int32_t node = boundary[std::size_t(n)];
    const Vec3& p_L = tissue.nodes_L[std::size_t(node)];
    const BoundaryLabel label = painted ? painted_at(*painted, p_L) : BoundaryLabel::kNone;
    NodeInterface& decided = map.nodes[std::size_t(n)];
    decided = label != BoundaryLabel::kNone ? rules.painted(p_L, label)
                                            : rules.by_rule(p_L, set_of[std::size_t(node)]);
    decided.node = node;
    if (is_on_lip[std::size_t(node)] == 0) return;
    if (decided.rule == InterfaceRule::kAir) decided.rule = InterfaceRule::kLips;
    if (decided.condition == InterfaceCondition::kSliding) decided.may_separate = true;
  });
  join_middle_nodes(map.nodes, tissue);
  if (options.interface == TissueInterface::kClinical)
    release_nodes_between_bones(map.nodes, tissue, is_on_lip,
                                [&](const Vec3& p_L) { return rules.is_near_air(p_L); });
  std::vector<std::pair<std::int32_t, Vec3>> planes;
  for (const NodeInterface& one : map.nodes)
    if (is_in_plane(one))
      for (const Vec3& normal_L :
           domain.planes_at(tissue.nodes_L[std::size_t(one.node)], kPlaneTolerance_mm))
        planes.push_back({one.node, normal_L});
  map.planes.resize(planes.size());
  parallel_for(std::ssize(planes), [&](Index n) {
    const auto& [node, normal_L] = planes[std::size_t(n)];
    map.planes[std::size_t(n)] = rules.plane_at(tissue.nodes_L[std::size_t(node)], normal_L);
    map.planes[std::size_t(n)].node = node;
  });
  return map;
}

std::vector<std::int32_t> nodes_with(const InterfaceMap& map,
                                     std::span<const InterfaceCondition> conditions) {
  std::vector<std::int32_t> nodes;
  for (const NodeInterface& one : map.nodes)
    if (std::find(conditions.begin(), conditions.end(), one.condition) != conditions.end())
      nodes.push_back(one.node);
  return nodes;
}

}  // namespace lefort::predict
