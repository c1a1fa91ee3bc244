/// \file
/// A block of tissue that a segment above presses onto stationary bone below, on which it slides:
///
///      |segment | moves down, tissue bonded
///      | tissue |  z = 9
///      |________|  z = 0
///    |stationary bone|
#include <lefort/predict/predict_face.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/box_mesh.h"
#include "support/face_phantom.h"
#include "support/paper_boundary.h"
#include "support/shapes.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_stationary_contact {
namespace {

using test::kHeight_mm;
using test::kSide_mm;

constexpr double kPressed_mm = 1.0;

/// The only fixed node, at the center of the bottom.
bool is_fixed(const Vec3& p_L) {
  return (p_L - Vec3(0.5 * kSide_mm, 0.5 * kSide_mm, 0.0)).norm() < 1e-9;
}

FaceModel pressed_block() {
  FaceModel model;
  model.tissue = test::box_mesh({.cells = {6, 6, 5}, .size_mm = {kSide_mm, kSide_mm, kHeight_mm}});
  auto& node_sets = model.tissue.node_sets;
  node_sets[sets::kMobilizedSegment] = node_sets.at("z1");
  for (const std::int32_t node : node_sets.at("z0"))
    if (is_fixed(model.tissue.nodes_L[std::size_t(node)])) node_sets[sets::kFixed].push_back(node);
  model.tissue.face_sets[sets::kContact] = {};
  model.segments.push_back(
      test::moved(test::make_box({-4.0, -4.0, kHeight_mm}, {16.0, 16.0, kHeight_mm + 10.0})));
  return model;
}

FaceModel sliding_block() {
  FaceModel model = pressed_block();
  model.tissue.face_sets[sets::kStationaryContact] = model.tissue.face_sets.at("z0");
  model.stationary_bone = test::moved(test::make_box({-6.0, -6.0, -10.0}, {18.0, 18.0, 0.0}));
  return model;
}

PredictionOptions bonded_options() {
  PredictionOptions options;
  options.boundary = test::bonded_boundary();
  return options;
}

struct Bottom {
  double lowest_mm = 0.0;    ///< Height of the lowest node.
  double furthest_mm = 0.0;  ///< Largest motion along the bone.
};

Bottom bottom_of(const FaceModel& model, const PredictionStep& step) {
  Bottom bottom;
  for (const std::int32_t node : model.tissue.node_sets.at("z0")) {
    const Vec3& u_mm = step.displacement_mm[std::size_t(node)];
    bottom.lowest_mm = std::min(bottom.lowest_mm, u_mm.z());
    bottom.furthest_mm = std::max(bottom.furthest_mm, u_mm.head<2>().norm());
  }
  return bottom;
}

TEST(StationaryContact, TissueSpreadsOnStationaryBoneWithoutEnteringIt) {
  const FaceModel free = pressed_block(), slides = sliding_block();
  const geometry::RigidPath path = test::straight({0.0, 0.0, -kPressed_mm}, 2);
  const auto pushed = predict_face(free, {path}, bonded_options()).value();
  PredictionOptions options = bonded_options();
  const auto pressed = predict_face(slides, {path}, options).value();
  ASSERT_TRUE(pushed.converged() && pressed.converged());
  EXPECT_EQ(pushed.steps.back().stationary_contact.points, 0);
  EXPECT_LT(bottom_of(free, pushed.steps.back()).lowest_mm, -0.7 * kPressed_mm);

  const Bottom bottom = bottom_of(slides, pressed.steps.back());
  EXPECT_GT(bottom.lowest_mm, -0.25 * kPressed_mm);  // Penetration of the penalty.
  EXPECT_GT(bottom.furthest_mm, 0.1 * kPressed_mm);
  const contact::ContactStatistics& contact = pressed.steps.back().stationary_contact;
  EXPECT_GT(contact.area_mm2, 0.8 * kSide_mm * kSide_mm);
  EXPECT_GT(contact.force_L_n.z(), 0.99 * contact.normal_force_n);  // Up, without friction.
  EXPECT_TRUE(pressed.nodal_contacts.empty());                      // No segment is touched.
  ASSERT_EQ(pressed.steps.back().segments.size(), 1U);
  EXPECT_EQ(pressed.steps.back().segments[0].contact.points, 0);

  options.contact.penetration_tolerance_mm = 0.01;
  const auto hardening = predict_face(slides, {path}, options).value();
  ASSERT_TRUE(hardening.converged());
  EXPECT_LE(hardening.steps.back().stationary_contact.p99_penetration_increase_mm, 0.01);
  EXPECT_GT(bottom_of(slides, hardening.steps.back()).lowest_mm, -0.05);
}

TEST(StationaryContact, LiftsOffWhereItIsPulled) {
  const FaceModel model = sliding_block();
  const geometry::RigidPath path = test::straight({0.0, 0.0, 0.5}, 1);
  const auto pulled = predict_face(model, {path}, bonded_options()).value();
  ASSERT_TRUE(pulled.converged());
  double highest_mm = 0.0;
  for (const std::int32_t node : model.tissue.node_sets.at("z0"))
    highest_mm = std::max(highest_mm, pulled.steps[0].displacement_mm[std::size_t(node)].z());
  EXPECT_GT(highest_mm, 0.3);
}

TEST(StationaryContact, ResumedAfterAStepGivesTheSameBits) {
  const FaceModel model = sliding_block();
  const geometry::RigidPath path = test::straight({0.2, 0.0, -kPressed_mm}, 3);
  std::vector<Restart> restarts;
  PredictionWatch watch;
  watch.on_restart = [&](const Restart& restart) { restarts.push_back(restart); };
  PredictionOptions options = bonded_options();
  options.contact.penetration_tolerance_mm = 0.02;
  const auto whole = predict_face(model, {path}, options, watch).value();
  ASSERT_TRUE(whole.converged());
  ASSERT_EQ(restarts.size(), 3U);
  const auto resumed =
      predict_face(model, {path}, options, {}, Progress::none(), restarts[0]).value();
  ASSERT_TRUE(resumed.converged());
  EXPECT_EQ(resumed.steps.back().displacement_mm, whole.steps.back().displacement_mm);
  EXPECT_EQ(resumed.steps.back().stationary_contact.normal_force_n,
            whole.steps.back().stationary_contact.normal_force_n);
}

TEST(StationaryContact, RejectsOpenBoneAndAToleranceBeyondItsField) {
  FaceModel model = sliding_block();
  geometry::TriangleMesh open = model.stationary_bone->surface_B;
  open.triangles.pop_back();
  model.stationary_bone = test::moved(open);
  const geometry::RigidPath path = test::straight({0.0, 0.0, -0.5}, 1);
  EXPECT_EQ(predict_face(model, {path}, bonded_options()).error().code, ErrorCode::kMeshInvalid);
  model = sliding_block();
  PredictionOptions wide = bonded_options();
  wide.boundary.contact_snap_mm = 3.5;
  EXPECT_EQ(predict_face(model, {path}, wide).error().code, ErrorCode::kInvalidArgument);
}

TEST(StationaryContact, IsNamedByTheLabelAndNotFixed) {
  const test::FacePhantom phantom = test::make_face_phantom();
  const TissueOptions options{
      .element_size_mm = 3.0, .far_element_size_mm = 3.0, .margin_mm = 15.0};
  const TissueDomain domain =
      make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, options);
  const mesh::VolumeMesh mesh = mesh_tissue(domain, phantom.segment_L, options).value();
  BoundaryLabelMap painted{phantom.grid,
                           std::vector<BoundaryLabel>(std::size_t(phantom.grid.voxel_count()))};
  for (Index k = 7; k < 10; ++k)  // On stationary bone, away from its boundary.
    for (Index j = 10; j < 31; ++j)
      for (Index i = 27; i < 33; ++i) painted.at(i, j, k) = BoundaryLabel::kContact;
  const auto named = [&](const BoundaryLabelMap* labels) {
    return test::find_phantom_boundary(mesh, domain, phantom, test::paper_boundary(4.0), labels)
        .tissue;
  };
  const mesh::VolumeMesh by_rule = named(nullptr), with_paint = named(&painted);
  EXPECT_FALSE(by_rule.face_sets.contains(sets::kStationaryContact));
  const auto& slides = with_paint.node_sets.at("painted_contact");
  EXPECT_GT(slides.size(), 10U);
  const auto is_in = [](const mesh::VolumeMesh& tissue, std::int32_t node) {
    const auto& fixed = tissue.node_sets.at(sets::kFixed);
    return std::binary_search(fixed.begin(), fixed.end(), node);
  };
  for (const std::int32_t node : slides) {
    EXPECT_TRUE(is_in(by_rule, node));
    EXPECT_FALSE(is_in(with_paint, node));
  }
  const auto& faces = with_paint.face_sets.at(sets::kStationaryContact);
  EXPECT_GE(faces.size(), slides.size());
  for (const mesh::Face& face : faces) {
    const auto nodes = nodes_of(face);
    EXPECT_TRUE(std::any_of(nodes.begin(), nodes.end(), [&](std::int32_t node) {
      return std::binary_search(slides.begin(), slides.end(), node);
    }));
  }
}

}  // namespace
}  // namespace lefort::predict::test_stationary_contact
