/// \file
/// Rules of the interface map on the face phantom: bone below z = 8, segment for x < 20, stationary
/// bone for x > 20; the region ends at x = 35.
#include <lefort/predict/interface_map.h>
#include <lefort/predict/interface_supports.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/tissue_boundary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

#include "support/face_phantom.h"
#include "support/paper_boundary.h"
#include "support/shapes.h"

namespace lefort::predict::test_interface_map {
namespace {

using Condition = InterfaceCondition;
using Rule = InterfaceRule;
using NodeList = std::vector<std::int32_t>;

const TissueOptions kOptions{.element_size_mm = 2.0, .far_element_size_mm = 2.0, .margin_mm = 15.0};
constexpr double kCut_mm = 20.0;  ///< x of the cut.

/// The cut face between the bones.
geometry::TriangleMesh cut_face() {
  geometry::TriangleMesh face;
  face.vertices = {{kCut_mm, 0.0, 0.0},
                   {kCut_mm, 40.0, 0.0},
                   {kCut_mm, 40.0, test::kPhantomBone_mm},
                   {kCut_mm, 0.0, test::kPhantomBone_mm}};
  face.triangles = {{0, 1, 2}, {0, 2, 3}};
  return face;
}

struct Phantom {
  test::FacePhantom bones = test::make_face_phantom();
  TissueDomain domain =
      make_tissue_domain(bones.soft_tissue_level, bones.grid, bones.segment_L, kOptions);
  mesh::VolumeMesh mesh = mesh_tissue(domain, bones.segment_L, kOptions).value();
};

const Phantom& phantom() {
  static const Phantom the_phantom;
  return the_phantom;
}

TissueBoundary boundary_of(const BoundaryOptions& options,
                           const std::vector<plan::ElevationZone>& zones = {},
                           const test::FacePhantom& bones = phantom().bones,
                           const BoundaryLabelMap* painted = nullptr) {
  return test::find_phantom_boundary(phantom().mesh, phantom().domain, bones, options, painted,
                                     zones);
}

Vec3 at(const NodeInterface& one) { return phantom().mesh.nodes_L[std::size_t(one.node)]; }

/// Far from the planes where the mesh ends.
bool is_inside(const Vec3& p_L) {
  return p_L.x() > 2.0 && p_L.x() < 33.5 && p_L.y() > 2.0 && p_L.y() < 38.0;
}

/// Calls `check` for each node on bone, far from the planes, with its distance from the cut.
void visit_nodes_on_bone(
    const InterfaceMap& map,
    const std::function<void(const NodeInterface&, double from_cut_mm)>& check) {
  int visited = 0;
  for (const NodeInterface& one : map.nodes) {
    const Vec3 p_L = at(one);
    if (!is_inside(p_L) || p_L.z() > test::kPhantomBone_mm + 0.1) continue;
    check(one, p_L.x() - kCut_mm);
    ++visited;
  }
  EXPECT_GT(visited, 100);
}

TEST(InterfaceMap, TissueIsElevatedWithinTheMarginOfEachSideOfACutAndElseBonded) {
  const TissueBoundary found =
      boundary_of({}, {{cut_face(), {.segment_mm = 5.0, .other_side_mm = 9.0}}});
  int elevated = 0, bonded = 0;
  visit_nodes_on_bone(found.interface, [&](const NodeInterface& one, double from_cut_mm) {
    const bool on_segment = one.bone == 0;
    EXPECT_TRUE(on_segment || one.bone == kStationaryBone);
    if (std::abs(from_cut_mm) > 1.0) {
      EXPECT_EQ(on_segment, from_cut_mm < 0.0) << from_cut_mm;
    }
    const bool is_near = std::abs(from_cut_mm) < (on_segment ? 5.0 : 9.0) - 0.05;
    const bool is_far = std::abs(from_cut_mm) > (on_segment ? 5.0 : 9.0) + 0.05;
    if (is_near) {
      EXPECT_EQ(one.condition, Condition::kElevated) << from_cut_mm;
      EXPECT_EQ(one.rule, Rule::kOsteotomy);
      ++elevated;
    } else if (is_far) {  // Bone on the other side of the cut, though near, is no joint.
      EXPECT_EQ(one.condition, Condition::kBonded) << from_cut_mm;
      EXPECT_EQ(one.rule, on_segment ? Rule::kSegment : Rule::kStationary);
      ++bonded;
    }
  });
  EXPECT_GT(elevated, 50);
  EXPECT_GT(bonded, 50);
  // Bonded tissue moves with its bone: a segment, or not at all.
  const NodeList& moved = found.tissue.node_sets.at(sets::kBonded);
  const NodeList& fixed = found.tissue.node_sets.at(sets::kFixed);
  for (const NodeInterface& one : found.interface.nodes) {
    const bool is_bonded = one.condition == Condition::kBonded;
    EXPECT_EQ(std::binary_search(moved.begin(), moved.end(), one.node), is_bonded && one.bone >= 0);
    EXPECT_EQ(std::binary_search(fixed.begin(), fixed.end(), one.node), is_bonded && one.bone < 0);
  }
}

TEST(InterfaceMap, TissueBetweenBonesThatNoOsteotomySeparatesSlides) {
  for (const double margin_mm : {4.0, 8.0}) {
    BoundaryOptions options;
    options.joint_margin_mm = margin_mm;
    const TissueBoundary found = boundary_of(options);
    visit_nodes_on_bone(found.interface, [&](const NodeInterface& one, double from_cut_mm) {
      if (std::abs(std::abs(from_cut_mm) - margin_mm) < 0.05) return;
      const bool is_near = std::abs(from_cut_mm) < margin_mm;
      EXPECT_EQ(one.condition, is_near ? Condition::kSliding : Condition::kBonded) << from_cut_mm;
      EXPECT_EQ(one.rule == Rule::kJoint, is_near);
      EXPECT_FALSE(one.may_separate);  // There is no air.
    });
    EXPECT_TRUE(slides_on_stationary_bone(found.interface));
  }
}

/// Where an element joins nodes that are bonded to two bones, its nodes slide.
TEST(InterfaceMap, NoElementIsBondedToTwoBones) {
  BoundaryOptions options;
  options.joint_margin_mm = 0.0;
  options.elevation_margin_mm = 0.0;
  const TissueBoundary found = boundary_of(options);
  std::vector<std::int32_t> bone_of(found.tissue.nodes_L.size(), kNoBone);
  int sliding = 0;
  for (const NodeInterface& one : found.interface.nodes) {
    if (one.condition == Condition::kBonded) bone_of[std::size_t(one.node)] = one.bone;
    if (one.condition != Condition::kSliding) continue;
    EXPECT_LT(std::abs(at(one).x() - kCut_mm), 5.0);  // Elements have edges of 2 mm.
    EXPECT_EQ(one.rule, Rule::kJoint);
    ++sliding;
  }
  EXPECT_GT(sliding, 20);
  for (const mesh::ElementBlock& block : found.tissue.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      bool on_segment = false, on_stationary = false;
      for (int n = 0; n < mesh::node_count(block.shape); ++n) {
        const std::int32_t bone = bone_of[std::size_t(block.element(e)[n])];
        on_segment |= bone == 0;
        on_stationary |= bone == kStationaryBone;
      }
      EXPECT_FALSE(on_segment && on_stationary);
    }
}

/// An osteotomy elsewhere does not separate the bones here.
TEST(InterfaceMap, AJointFarFromTheCutStaysAJoint) {
  geometry::TriangleMesh far_cut = cut_face();
  for (Vec3& vertex : far_cut.vertices) vertex.z() -= 40.0;
  const TissueBoundary found =
      boundary_of({}, {{far_cut, {.segment_mm = 5.0, .other_side_mm = 9.0}}});
  visit_nodes_on_bone(found.interface, [&](const NodeInterface& one, double from_cut_mm) {
    if (std::abs(from_cut_mm) < 7.9) {
      EXPECT_EQ(one.condition, Condition::kSliding) << from_cut_mm;
    }
  });
}

TEST(InterfaceMap, SlidingTissueMaySeparateNearAir) {
  test::FacePhantom bones = test::make_face_phantom();
  for (Index k = 9; k < 11; ++k)  // From 8.5 mm up, for y up to 20.5 mm.
    for (Index j = 0; j <= 20; ++j)
      for (Index i = 0; i < 41; ++i) bones.labels.at(i, j, k) = anatomy::Tissue::kAirway;
  const TissueBoundary found = boundary_of({}, {}, bones);
  int loose = 0, held = 0;
  for (const NodeInterface& one : found.interface.nodes) {
    const Vec3 p_L = at(one);
    if (one.condition != Condition::kSliding || !is_inside(p_L)) continue;
    if (p_L.y() < 20.0) {
      EXPECT_TRUE(one.may_separate) << p_L.transpose();
      ++loose;
    } else if (p_L.y() > 22.6) {  // 2 mm from the voxels.
      EXPECT_FALSE(one.may_separate) << p_L.transpose();
      ++held;
    }
  }
  EXPECT_GT(loose, 20);
  EXPECT_GT(held, 20);
}

TEST(InterfaceMap, EachNodeHasTheConditionOfItsPlaneSkinOrAir) {
  for (const auto& [boundary, condition] :
       {std::pair{OuterBoundary::kRoller, Condition::kRoller},
        std::pair{OuterBoundary::kFoundation, Condition::kFoundation},
        std::pair{OuterBoundary::kFree, Condition::kFree},
        std::pair{OuterBoundary::kFixed, Condition::kFixed}}) {
    BoundaryOptions options;
    options.cut_boundary = boundary;
    options.scan_boundary = OuterBoundary::kFree;
    const TissueBoundary found = boundary_of(options);
    int skin = 0, cut = 0, scan = 0, on_bone = 0;
    for (const NodeInterface& one : found.interface.nodes) {
      const Vec3 p_L = at(one);
      const bool is_between = p_L.z() > 9.0 && p_L.z() < 19.0;
      if (is_inside(p_L) && p_L.z() > 19.9) {
        EXPECT_EQ(one.condition, Condition::kFree);
        EXPECT_EQ(one.rule, Rule::kSkin);
        ++skin;
      } else if (p_L.x() > 34.99 && is_between && p_L.y() > 2.0 && p_L.y() < 38.0) {
        EXPECT_EQ(one.condition, condition);
        EXPECT_EQ(one.rule, Rule::kCutBoundary);
        ++cut;
      } else if (p_L.x() < 0.51 && is_between) {
        EXPECT_EQ(one.condition, Condition::kFree);
        EXPECT_EQ(one.rule, Rule::kScanBoundary);
        ++scan;
      } else if (p_L.x() > 34.99 && p_L.z() < 8.1) {  // Bone holds tissue in the plane, too.
        EXPECT_EQ(one.condition, Condition::kBonded);
        EXPECT_EQ(one.bone, kStationaryBone);
        ++on_bone;
      }
    }
    EXPECT_GT(skin, 50);
    EXPECT_GT(cut, 20);
    EXPECT_GT(scan, 20);
    EXPECT_GT(on_bone, 5);
  }
}

/// Paints the lower side for x from `from` to `to`.
BoundaryLabelMap painted_below(double from, double to, BoundaryLabel label) {
  BoundaryLabelMap painted{phantom().bones.grid, {}};
  const image::Grid& grid = painted.grid;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const Vec3 p_L = grid.point_L(Vec3(double(i), double(j), double(k)));
        const bool is_in = p_L.x() >= from && p_L.x() <= to && p_L.z() < 11.0;
        painted.values.push_back(is_in ? label : BoundaryLabel::kNone);
      }
  return painted;
}

struct PaintedAs {
  BoundaryLabel label;
  Condition condition;
  std::int32_t on_segment, on_stationary;  ///< NodeInterface::bone.
};

TEST(InterfaceMap, APaintedLabelOverridesEachRule) {
  for (const auto& [label, condition, on_segment, on_stationary] :
       {PaintedAs{BoundaryLabel::kFixed, Condition::kFixed, kNoBone, kNoBone},
        PaintedAs{BoundaryLabel::kFree, Condition::kContact, kNoBone, kNoBone},
        PaintedAs{BoundaryLabel::kContact, Condition::kContact, kNoBone, kNoBone},
        PaintedAs{BoundaryLabel::kWithSegment, Condition::kBonded, 0, 0},
        PaintedAs{BoundaryLabel::kBonded, Condition::kBonded, 0, kStationaryBone},
        PaintedAs{BoundaryLabel::kElevated, Condition::kElevated, 0, kStationaryBone},
        PaintedAs{BoundaryLabel::kSliding, Condition::kSliding, 0, kStationaryBone}})
    for (const auto& [from, to] : {std::pair{5.0, 18.0}, std::pair{22.0, 32.0}}) {
      const BoundaryLabelMap painted = painted_below(from, to, label);
      const TissueBoundary found = boundary_of(
          {}, {{cut_face(), {.segment_mm = 5.0, .other_side_mm = 5.0}}}, phantom().bones, &painted);
      visit_nodes_on_bone(found.interface, [&](const NodeInterface& one, double from_cut_mm) {
        const double x = from_cut_mm + kCut_mm;
        if (x > from + 0.5 && x < to - 0.5) {
          EXPECT_EQ(one.rule, Rule::kPainted);
          EXPECT_EQ(one.condition, condition) << int(label);
          EXPECT_EQ(one.bone, x < kCut_mm ? on_segment : on_stationary) << int(label);
        } else if (x < from - 1.0 || x > to + 1.0) {
          EXPECT_NE(one.rule, Rule::kPainted);
        }
      });
    }
}

/// Fixed nodes as they were before the interface map: the cut, the scan boundary if required, and
/// tissue on stationary bone and brain beyond the margin from the segment.
NodeList formerly_fixed(const mesh::VolumeMesh& tissue, const BoundaryOptions& options) {
  NodeList fixed = tissue.node_sets.at(sets::kCut);
  const auto add = [&](const char* set, double margin_mm) {
    for (const std::int32_t node : tissue.node_sets.at(set)) {
      const Vec3& p = tissue.nodes_L[std::size_t(node)];
      const Vec3 beyond = (p - Vec3(kCut_mm, 40.0, test::kPhantomBone_mm)).cwiseMax(0.0);
      if (!(beyond.norm() < margin_mm)) fixed.push_back(node);
    }
  };
  if (options.scan_boundary == OuterBoundary::kFixed) add(sets::kScanBoundary, 0.0);
  const double margin_mm = options.elevation_margin_mm.value_or(8.0);
  add(sets::kStationaryBone, margin_mm);
  add(sets::kBrain, margin_mm);
  std::sort(fixed.begin(), fixed.end());
  return fixed;
}

TEST(InterfaceMap, ContactAndBondedHaveTheSetsOfThePaper) {
  for (const std::optional<double> margin_mm :
       {std::optional<double>(), std::optional(0.0), std::optional(4.0), std::optional(100.0)})
    for (const OuterBoundary scan : {OuterBoundary::kFree, OuterBoundary::kFixed})
      for (BoundaryOptions options :
           {test::paper_boundary(margin_mm), test::bonded_boundary(margin_mm)}) {
        options.scan_boundary = scan;
        // The zones are those of the clinical interface.
        const TissueBoundary found =
            boundary_of(options, {{cut_face(), {.segment_mm = 5.0, .other_side_mm = 9.0}}});
        EXPECT_EQ(found.tissue.node_sets.at(sets::kFixed), formerly_fixed(found.tissue, options));
        const bool is_bonded = options.interface == TissueInterface::kBonded;
        EXPECT_EQ(found.tissue.node_sets.at(sets::kBonded),
                  is_bonded ? found.tissue.node_sets.at(sets::kMobilizedSegment) : NodeList{});
        EXPECT_FALSE(found.tissue.face_sets.contains(sets::kStationaryContact));
        EXPECT_TRUE(found.interface.planes.empty());
        const InterfaceSupports supports =
            interface_supports(found.tissue, found.interface, 1, kOptions, options);
        EXPECT_TRUE(supports.on_segments[0].empty() && supports.on_stationary.empty() &&
                    supports.on_planes.empty());
      }
}

TEST(InterfaceMap, PlanesFollowASegmentThatCrossesThem) {
  const TissueBoundary found = boundary_of({});
  int crossed = 0, not_crossed = 0;
  for (const NodePlane& plane : found.interface.planes) {
    const Vec3& p = found.tissue.nodes_L[std::size_t(plane.node)];
    if (plane.normal_L.x() < -0.5) {  // The end of the region, at x = 35: the segment ends at 20.
      EXPECT_NEAR(p.x(), 35.0, 0.05);
      EXPECT_EQ(plane.segment, kStationaryBone);
      EXPECT_EQ(plane.motion_fraction, 0.0);
      ++not_crossed;
    } else if (std::abs(plane.normal_L.y()) > 0.5) {  // The scan ends in both bones.
      const double up = p.z() - test::kPhantomBone_mm;
      const double segment_mm = std::hypot(up, std::max(p.x() - kCut_mm, 0.0));
      const double stationary_mm = std::hypot(up, std::max(kCut_mm - p.x(), 0.0));
      const double wanted = 1.0 / segment_mm / segment_mm /
                            (1.0 / segment_mm / segment_mm + 1.0 / stationary_mm / stationary_mm);
      EXPECT_EQ(plane.segment, 0);
      EXPECT_NEAR(plane.motion_fraction, wanted, 1e-6) << p.transpose();
      ++crossed;
    }
  }
  EXPECT_GT(crossed, 20);
  EXPECT_GT(not_crossed, 20);
}

TEST(InterfaceMap, ConditionsAndRulesHaveNamesAndLettersOfTheirOwn) {
  std::vector<std::string> names;
  std::vector<char> letters;
  for (const auto& style : kInterfaceConditions) {
    EXPECT_STREQ(style_of(style.condition).name, style.name);
    names.push_back(style.name);
    letters.push_back(style.letter);
  }
  const auto expect_distinct = [&] {
    std::sort(names.begin(), names.end());
    std::sort(letters.begin(), letters.end());
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
    EXPECT_EQ(std::adjacent_find(letters.begin(), letters.end()), letters.end());
    names.clear();
    letters.clear();
  };
  expect_distinct();
  for (const auto& style : kInterfaceRules) {
    EXPECT_STREQ(style_of(style.rule).name, style.name);
    names.push_back(style.name);
    letters.push_back(style.letter);
  }
  expect_distinct();
}

}  // namespace
}  // namespace lefort::predict::test_interface_map
