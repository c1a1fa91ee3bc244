/// \file
/// The interface map: a boundary condition for each node of the tissue boundary, and the rule that
/// set it. Described in docs/theory/interface.md.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/plan/elevation_zone.h>
#include <lefort/predict/boundary_labels.h>
#include <lefort/predict/jaw_teeth.h>
#include <lefort/predict/prediction_options.h>
#include <lefort/predict/tissue_domain.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::predict {

/// Boundary condition of a node of the tissue boundary.
enum class InterfaceCondition : std::uint8_t {
  kFree,        ///< No traction: skin.
  kContact,     ///< Bones push it, without friction; nothing holds it.
  kBonded,      ///< Moves with its bone.
  kElevated,    ///< Bones push it; it slides and lifts off, and heals where it then lies.
  kSliding,     ///< Stays on its bone, moves freely along it; near air it may separate.
  kFixed,       ///< Does not move, and is not assigned to a bone.
  kRoller,      ///< OuterBoundary::kRoller.
  kFoundation,  ///< OuterBoundary::kFoundation.
};

/// What decided the condition of a node.
enum class InterfaceRule : std::uint8_t {
  kPainted,       ///< boundary.labels.
  kOsteotomy,     ///< Bone near an osteotomy.
  kJoint,         ///< Bone near bone that moves relative to it: occluding teeth, jaw joint.
  kSegment,       ///< A mobilized segment.
  kStationary,    ///< Stationary bone.
  kBrain,         ///< Border of the cranial cavity.
  kScanBoundary,  ///< The scan ends here.
  kCutBoundary,   ///< The meshed region ends here; not an osteotomy.
  kSkin,          ///< Outer surface.
  kAir,           ///< Inner surface that lies on no bone: airway, sinus, oral cavity.
  kLips,          ///< Where the lips touch each other at rest (separate_lips.h).
  kVestibule,     ///< Teeth and gingiva, facing lips, cheeks and tongue (oral_vestibule.h).
  kOverlap,       ///< Bone that lies in another bone along the path (release_overlap.h).
  kCrown,         ///< Crown of a known tooth (jaw_teeth.h).
};

/// Name and letter of a condition in results.
struct InterfaceConditionStyle {
  InterfaceCondition condition;
  const char* name;
  char letter;
};
inline constexpr std::array<InterfaceConditionStyle, 8> kInterfaceConditions{{
    {InterfaceCondition::kFree, "free", 'f'},
    {InterfaceCondition::kContact, "contact", 'c'},
    {InterfaceCondition::kBonded, "bonded", 'b'},
    {InterfaceCondition::kElevated, "elevated", 'e'},
    {InterfaceCondition::kSliding, "sliding", 's'},
    {InterfaceCondition::kFixed, "fixed", 'x'},
    {InterfaceCondition::kRoller, "roller", 'r'},
    {InterfaceCondition::kFoundation, "foundation", 'w'},
}};

/// Name and letter of a rule in results.
struct InterfaceRuleStyle {
  InterfaceRule rule;
  const char* name;
  char letter;
};
inline constexpr std::array<InterfaceRuleStyle, 14> kInterfaceRules{{
    {InterfaceRule::kPainted, "painted", 'p'},
    {InterfaceRule::kOsteotomy, "osteotomy", 'o'},
    {InterfaceRule::kJoint, "joint", 'j'},
    {InterfaceRule::kSegment, "segment", 'm'},
    {InterfaceRule::kStationary, "stationary bone", 't'},
    {InterfaceRule::kBrain, "brain", 'n'},
    {InterfaceRule::kScanBoundary, "scan boundary", 'd'},
    {InterfaceRule::kCutBoundary, "cut boundary", 'u'},
    {InterfaceRule::kSkin, "skin", 'k'},
    {InterfaceRule::kAir, "air", 'a'},
    {InterfaceRule::kLips, "lips", 'l'},
    {InterfaceRule::kVestibule, "vestibule", 'v'},
    {InterfaceRule::kOverlap, "overlap", 'x'},
    {InterfaceRule::kCrown, "crown", 'c'},
}};

[[nodiscard]] const InterfaceConditionStyle& style_of(InterfaceCondition condition);
[[nodiscard]] const InterfaceRuleStyle& style_of(InterfaceRule rule);

/// Values of NodeInterface::bone that are not the index of a segment.
inline constexpr std::int32_t kStationaryBone = -1, kNoBone = -2;

/// Condition of one node.
struct NodeInterface {
  std::int32_t node = 0;
  InterfaceCondition condition = InterfaceCondition::kFree;
  InterfaceRule rule = InterfaceRule::kAir;
  std::int32_t bone = kNoBone;  ///< Index of the segment, kStationaryBone or kNoBone.
  bool may_separate = false;    ///< kSliding: air or the other lip is near, so it can lift off.
};

/// A node in a plane where the mesh ends. If a segment crosses that plane, it continues beyond the
/// scan and moves the tissue there: the node then follows a fraction of its motion.
struct NodePlane {
  std::int32_t node = 0;
  Vec3 normal_L = Vec3::UnitZ();           ///< Unit length.
  std::int32_t segment = kStationaryBone;  ///< Index of the segment that crosses, if any.
  double motion_fraction = 0.0;            ///< 0 to 1.
};

/// Conditions of all nodes of the tissue boundary.
struct InterfaceMap {
  std::vector<NodeInterface> nodes;  ///< Ascending by node.
  std::vector<NodePlane> planes;  ///< Of the nodes with kRoller and kFoundation; one or more each.
};

/// The bones around the tissue.
struct InterfaceBones {
  std::span<const geometry::TriangleMesh> segments_L;
  const geometry::TriangleMesh& remainder_L;
  std::span<const plan::ElevationZone> elevation;  ///< Used by TissueInterface::kClinical.
  const JawTeeth* teeth = nullptr;                 ///< As `elevation`; may be null.
};

/// Decides the condition of every boundary node.
///
/// \param tissue   mesh with the node sets of name_tissue_boundary(), and those of the lips if they
///   are separated.
/// \param domain   its planes are used.
/// \param labels   of the scan; airway is used.
/// \param bones    at rest.
/// \param options  interface, boundaries and distances.
/// \param painted  may be null; its labels override the rules.
[[nodiscard]] InterfaceMap make_interface_map(
    const mesh::VolumeMesh& tissue, const TissueDomain& domain, const anatomy::LabelMap& labels,
    const InterfaceBones& bones, const BoundaryOptions& options, const BoundaryLabelMap* painted);

/// Nodes with one of the conditions, ascending.
[[nodiscard]] std::vector<std::int32_t> nodes_with(const InterfaceMap& map,
                                                   std::span<const InterfaceCondition> conditions);

}  // namespace lefort::predict
