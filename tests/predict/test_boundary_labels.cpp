#include <lefort/field/build/build_distance_field.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/boundary_labels.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/tissue_boundary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "support/face_phantom.h"
#include "support/paper_boundary.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_boundary_labels {
namespace {

using NodeList = std::vector<std::int32_t>;

const TissueOptions kOptions{.element_size_mm = 4.0, .far_element_size_mm = 4.0, .margin_mm = 15.0};
const Vec3 kUp_mm{0.0, 0.0, 1.5};

using Painting = std::function<BoundaryLabel(const Vec3&)>;

BoundaryLabelMap paint(const image::Grid& grid, const Painting& label_at) {
  BoundaryLabelMap painted{grid, {}};
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        painted.values.push_back(label_at(grid.point_L(Vec3(double(i), double(j), double(k)))));
  return painted;
}

/// Paints the lower side for x from `from` to `to`, far from the cut planes.
Painting below(double from, double to, BoundaryLabel label) {
  return [=](const Vec3& p) {
    return p.x() >= from && p.x() <= to && p.y() >= 10.0 && p.y() <= 30.0 && p.z() < 11.0
               ? label
               : BoundaryLabel::kNone;
  };
}

FaceModel phantom_face(const BoundaryOptions& options, const Painting& label_at = {}) {
  const test::FacePhantom phantom = test::make_face_phantom();
  const TissueDomain domain =
      make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, kOptions);
  static const mesh::VolumeMesh bare = mesh_tissue(domain, phantom.segment_L, kOptions).value();
  const BoundaryLabelMap painted = label_at ? paint(phantom.grid, label_at) : BoundaryLabelMap{};
  FaceModel model;
  TissueBoundary boundary =
      test::find_phantom_boundary(bare, domain, phantom, options, label_at ? &painted : nullptr);
  model.tissue = std::move(boundary.tissue);
  model.interface = std::move(boundary.interface);
  static const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(phantom.segment_L,
                                  {.resolution = 64, .band_mm = 4.0, .smooth = true})
          .value());
  model.segments = {{phantom.segment_L, field}};
  return model;
}

/// Displacements of nodes below 9 mm, well within the painted patch, when the segment rises.
struct MovedNodes {
  double min_mm = 1e9, max_mm = 0.0;
  double off_the_bone_mm = 0.0;  ///< Largest difference from the motion of the segment.
  int nodes = 0;
};

MovedNodes moved_nodes(const FaceModel& model, const BoundaryOptions& boundary, double from,
                       double to) {
  PredictionOptions options;
  options.tissue = kOptions;
  options.boundary = boundary;
  const auto prediction = predict_face(model, {test::straight(kUp_mm, 1)}, options);
  EXPECT_TRUE(prediction && prediction->converged());
  MovedNodes moved;
  if (!prediction || !prediction->converged()) return moved;
  for (const std::int32_t node : model.tissue.node_sets.at("boundary")) {
    const Vec3& p = model.tissue.nodes_L[std::size_t(node)];
    if (below(from, to, BoundaryLabel::kFree)(p) != BoundaryLabel::kFree || p.z() > 9.0) continue;
    const Vec3& u = prediction->steps.back().displacement_mm[std::size_t(node)];
    moved.min_mm = std::min(moved.min_mm, u.norm());
    moved.max_mm = std::max(moved.max_mm, u.norm());
    moved.off_the_bone_mm = std::max(moved.off_the_bone_mm, (u - kUp_mm).norm());
    ++moved.nodes;
  }
  EXPECT_GT(moved.nodes, 3);
  return moved;
}

TEST(BoundaryLabels, TheClosestPaintedVoxelWithinHalfADiagonalDecides) {
  image::Grid grid;
  grid.size = {4, 4, 3};
  grid.spacing_mm = Vec3(0.5, 0.5, 2.0);
  grid.origin_L = Vec3(10.0, 20.0, 30.0);
  BoundaryLabelMap painted{grid, std::vector<BoundaryLabel>(48, BoundaryLabel::kNone)};
  painted.at(1, 1, 1) = BoundaryLabel::kFixed;
  painted.at(3, 1, 1) = BoundaryLabel::kFree;
  const double max_mm = max_paint_distance_mm(grid);
  EXPECT_NEAR(max_mm, 0.5 * std::sqrt(4.5), 1e-12);
  const Vec3 fixed_L = grid.point_L(Vec3(1, 1, 1)), free_L = grid.point_L(Vec3(3, 1, 1));
  EXPECT_EQ(painted_at(painted, fixed_L), BoundaryLabel::kFixed);
  EXPECT_EQ(painted_at(painted, free_L), BoundaryLabel::kFree);
  EXPECT_EQ(painted_at(painted, fixed_L + Vec3(0.45, 0, 0)), BoundaryLabel::kFixed);
  EXPECT_EQ(painted_at(painted, fixed_L + Vec3(0.55, 0, 0)), BoundaryLabel::kFree);
  EXPECT_EQ(painted_at(painted, fixed_L + Vec3(0.5, 0, 0)),
            BoundaryLabel::kFixed);  // Equally close.
  EXPECT_EQ(painted_at(painted, fixed_L - Vec3(0.25, 0.25, 1.0)), BoundaryLabel::kFixed);
  EXPECT_EQ(painted_at(painted, fixed_L - Vec3(0, 0, max_mm - 1e-6)), BoundaryLabel::kFixed);
  EXPECT_EQ(painted_at(painted, fixed_L - Vec3(0, 0, max_mm + 1e-6)), BoundaryLabel::kNone);
  EXPECT_EQ(painted_at(painted, free_L + Vec3(max_mm - 1e-6, 0, 0)),
            BoundaryLabel::kFree);  // Outside the scan.
  EXPECT_EQ(painted_at(painted, Vec3(1e9, -1e9, 0)), BoundaryLabel::kNone);
}

TEST(BoundaryLabels, WithoutALabelTheRuleDecides) {
  const BoundaryOptions boundary = test::paper_boundary();
  const FaceModel by_rule = phantom_face(boundary);
  const FaceModel painted = phantom_face(boundary, below(20.0, 26.0, BoundaryLabel::kFixed));
  const FaceModel blank = phantom_face(boundary, [](const Vec3&) { return BoundaryLabel::kNone; });
  for (const auto& [set, nodes] : by_rule.tissue.node_sets) {
    EXPECT_EQ(blank.tissue.node_sets.at(set), nodes) << set;
    if (set != sets::kFixed) {
      EXPECT_EQ(painted.tissue.node_sets.at(set), nodes) << set;
    }
  }
  EXPECT_EQ(by_rule.tissue.node_sets.count("painted_fixed"), 0U);
  const NodeList& before = by_rule.tissue.node_sets.at(sets::kFixed);
  const NodeList& after = painted.tissue.node_sets.at(sets::kFixed);
  const NodeList& patch = painted.tissue.node_sets.at("painted_fixed");
  EXPECT_GT(after.size(), before.size());
  EXPECT_TRUE(std::includes(after.begin(), after.end(), patch.begin(), patch.end()));
  for (const std::int32_t node : after)
    EXPECT_TRUE(std::binary_search(before.begin(), before.end(), node) ||
                std::binary_search(patch.begin(), patch.end(), node));
  for (const std::int32_t node : patch) {
    const Vec3& p = by_rule.tissue.nodes_L[std::size_t(node)];
    EXPECT_GE(p.x(), 19.1);  // Half a diagonal of a voxel of 1 mm.
    EXPECT_LE(p.x(), 26.9);
  }
}

TEST(BoundaryLabels, FixedOverridesARuleThatFreesTissue) {
  const BoundaryOptions boundary = test::paper_boundary(9.0);
  EXPECT_GT(moved_nodes(phantom_face(boundary), boundary, 22.0, 28.0).max_mm, 0.1);
  const FaceModel painted = phantom_face(boundary, below(21.0, 29.0, BoundaryLabel::kFixed));
  EXPECT_EQ(moved_nodes(painted, boundary, 22.0, 28.0).max_mm, 0.0);
}

TEST(BoundaryLabels, FreeOverridesARuleThatFixesTissue) {
  const BoundaryOptions boundary = test::paper_boundary(0.0);
  EXPECT_EQ(moved_nodes(phantom_face(boundary), boundary, 23.0, 28.0).max_mm, 0.0);
  const FaceModel painted = phantom_face(boundary, below(21.0, 30.0, BoundaryLabel::kFree));
  EXPECT_GT(moved_nodes(painted, boundary, 23.0, 28.0).min_mm, 0.01);
}

TEST(BoundaryLabels, WithSegmentMovesExactlyAsTheBoneThoughOtherTissueSlides) {
  const BoundaryOptions boundary = test::paper_boundary(0.0);
  const FaceModel painted = phantom_face(boundary, below(4.0, 16.0, BoundaryLabel::kWithSegment));
  EXPECT_LT(moved_nodes(painted, boundary, 5.0, 15.0).off_the_bone_mm, 1e-12);
  EXPECT_GT(moved_nodes(phantom_face(boundary), boundary, 5.0, 15.0).off_the_bone_mm, 1e-6);
  // On stationary bone, which is fixed by the rule.
  const FaceModel on_stationary_bone =
      phantom_face(boundary, below(23.0, 33.0, BoundaryLabel::kWithSegment));
  EXPECT_LT(moved_nodes(on_stationary_bone, boundary, 24.0, 32.0).off_the_bone_mm, 1e-12);
}

TEST(BoundaryLabels, FreeOverridesABondedInterface) {
  const BoundaryOptions boundary = test::bonded_boundary(0.0);
  EXPECT_LT(moved_nodes(phantom_face(boundary), boundary, 5.0, 15.0).off_the_bone_mm, 1e-12);
  const FaceModel painted = phantom_face(boundary, below(4.0, 16.0, BoundaryLabel::kFree));
  EXPECT_GT(moved_nodes(painted, boundary, 5.0, 15.0).off_the_bone_mm, 0.01);
}

TEST(BoundaryLabels, EachNodeIsCountedOnce) {
  const BoundaryOptions boundary = test::paper_boundary(4.0);
  const auto label_at = [](const Vec3& p) {
    const bool is_front = p.y() < 20.0;
    if (p.x() < 10.0)
      return below(4.0, 10.0, is_front ? BoundaryLabel::kWithSegment : BoundaryLabel::kBonded)(p);
    if (p.x() < 19.0)
      return below(12.0, 19.0, is_front ? BoundaryLabel::kElevated : BoundaryLabel::kSliding)(p);
    if (p.x() < 25.0) return below(20.0, 25.0, BoundaryLabel::kFixed)(p);
    return below(26.0, 32.0, is_front ? BoundaryLabel::kFree : BoundaryLabel::kContact)(p);
  };
  const mesh::VolumeMesh tissue = phantom_face(boundary, label_at).tissue;
  Index decided = 0, painted_over = 0, painted = 0, fixed = 0;
  for (const BoundaryRuleStatistics& rule : boundary_rule_statistics(tissue, boundary)) {
    decided += rule.fixed + rule.with_segment + rule.free;
    painted_over += rule.painted;
    fixed += rule.fixed;
    EXPECT_EQ(rule.with_segment, 0);  // It slides where it is not painted.
    EXPECT_EQ(rule.within_mm.has_value(), rule.set != sets::kFree);
    if (rule.set == sets::kStationaryBone) {
      EXPECT_EQ(rule.within_mm, boundary.contact_snap_mm);
      EXPECT_GT(rule.painted, 0);
    }
  }
  const std::vector<BoundaryLabelStatistics> by_label = boundary_label_statistics(tissue);
  ASSERT_EQ(by_label.size(), std::size(kBoundaryLabelStyles));
  for (const BoundaryLabelStatistics& decision : by_label) {
    EXPECT_GT(decision.nodes, 0) << decision.label.name;
    painted += decision.nodes;
  }
  EXPECT_EQ(painted, painted_over);
  EXPECT_EQ(decided + painted, Index(tissue.node_sets.at("boundary").size()));
  EXPECT_EQ(fixed + by_label[0].nodes, Index(tissue.node_sets.at(sets::kFixed).size()));

  // The areas, too: their sum is the area of the boundary.
  double area_mm2 = 0.0, by_rule_mm2 = 0.0, over_mm2 = 0.0, painted_mm2 = 0.0;
  for (const mesh::Face3& face : mesh::triangles_of(tissue.face_sets.at("boundary"))) {
    const auto p = [&](std::size_t n) { return tissue.nodes_L[std::size_t(face[n])]; };
    area_mm2 += 0.5 * (p(1) - p(0)).cross(p(2) - p(0)).norm();
  }
  for (const BoundaryRuleStatistics& rule : boundary_rule_statistics(tissue, boundary)) {
    by_rule_mm2 += rule.areas.fixed_mm2 + rule.areas.with_segment_mm2 + rule.areas.free_mm2;
    over_mm2 += rule.areas.painted_mm2;
    EXPECT_EQ(rule.areas.fixed_mm2 > 0.0, rule.fixed > 0) << rule.set;
  }
  for (const BoundaryLabelStatistics& decision : by_label) {
    EXPECT_GT(decision.area_mm2, 0.0) << decision.label.name;
    painted_mm2 += decision.area_mm2;
  }
  EXPECT_NEAR(painted_mm2, over_mm2, 1e-9 * area_mm2);
  EXPECT_NEAR(by_rule_mm2 + painted_mm2, area_mm2, 1e-9 * area_mm2);

  const std::string reported = describe_boundary(tissue, boundary);
  EXPECT_NE(reported.find("within 0.8 mm"), std::string::npos) << reported;
  EXPECT_NE(reported.find("with segment "), std::string::npos) << reported;
  EXPECT_TRUE(boundary_label_statistics(phantom_face(boundary).tissue).empty());
}

TEST(BoundaryLabels, BonesPushElevatedTissueAlsoWhereTheRestIsBonded) {
  const BoundaryOptions boundary = test::bonded_boundary();
  EXPECT_TRUE(phantom_face(boundary).tissue.face_sets.at(sets::kContact).empty());
  FaceModel model = phantom_face(boundary, below(10.0, 26.0, BoundaryLabel::kElevated));
  EXPECT_FALSE(model.tissue.face_sets.at(sets::kContact).empty());
  EXPECT_EQ(model.tissue.face_sets.count(sets::kStationaryContact), 1U);
  model.stationary_bone = test::moved(test::make_face_phantom().remainder_L);
  PredictionOptions options;
  options.tissue = kOptions;
  options.boundary = boundary;
  const auto prediction = predict_face(model, {test::straight(kUp_mm, 1)}, options);
  ASSERT_TRUE(prediction && prediction->converged());
  const contact::ContactStatistics& contact = prediction->steps.back().segments.front().contact;
  EXPECT_GT(contact.nodes, 3);
  EXPECT_LT(contact.max_penetration_increase_mm, 0.5 * kUp_mm.z());
}

TEST(BoundaryLabels, ABondedNodeMovesWithTheBoneOfTheMap) {
  FaceModel model = phantom_face(test::bonded_boundary());
  model.segments.push_back(model.segments.front());  // Equally close: the map decides.
  std::vector<NodeInterface> bonded;
  for (NodeInterface& node : model.interface.nodes)
    if (node.condition == InterfaceCondition::kBonded && node.bone == 0) {
      node.bone = std::int32_t(bonded.size() % 2);
      bonded.push_back(node);
    }
  ASSERT_GT(bonded.size(), 4U);
  const auto lists = bonded_by_segment(model, TissueInterface::kBonded);
  ASSERT_EQ(lists.size(), 2U);
  EXPECT_EQ(lists[0].size() + lists[1].size(), bonded.size());
  for (const NodeInterface& node : bonded)
    EXPECT_TRUE(std::ranges::binary_search(lists[std::size_t(node.bone)], node.node));
}

}  // namespace
}  // namespace lefort::predict::test_boundary_labels
