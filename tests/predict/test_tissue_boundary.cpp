#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/tissue_boundary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/face_phantom.h"
#include "support/paper_boundary.h"

namespace lefort::predict::test_tissue_boundary {
namespace {

const TissueOptions kOptions{.element_size_mm = 3.0, .far_element_size_mm = 3.0, .margin_mm = 15.0};

mesh::VolumeMesh phantom_tissue(const BoundaryOptions& options) {
  test::FacePhantom phantom = test::make_face_phantom();
  const TissueDomain domain =
      make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, kOptions);
  static const mesh::VolumeMesh bare =
      mesh_tissue(domain, phantom.segment_L, kOptions).value();  // The same for every test.
  return test::find_phantom_boundary(bare, domain, phantom, options).tissue;
}

std::set<std::int32_t> nodes_where(const mesh::VolumeMesh& mesh, const char* set) {
  const auto& nodes = mesh.node_sets.at(set);
  return {nodes.begin(), nodes.end()};
}

TEST(TissueBoundary, NamesEverySideOfThePhantom) {
  const mesh::VolumeMesh tissue = phantom_tissue(test::paper_boundary(4.0));
  const auto far_inside = [](const Vec3& p) {
    return p.x() > 2.0 && p.x() < 33.0 && p.y() > 2.0 && p.y() < 38.0;
  };
  int moved = 0, stationary = 0, skin = 0;
  for (const std::int32_t node : tissue.node_sets.at("boundary")) {
    const Vec3& p = tissue.nodes_L[std::size_t(node)];
    if (!far_inside(p)) continue;
    if (p.z() > 19.9) {
      EXPECT_TRUE(nodes_where(tissue, sets::kSkin).count(node)) << p.transpose();
      ++skin;
    } else if (p.z() < 8.1) {
      const bool on_segment = nodes_where(tissue, sets::kMobilizedSegment).count(node) > 0;
      const bool on_remainder = nodes_where(tissue, sets::kStationaryBone).count(node) > 0;
      EXPECT_NE(on_segment, on_remainder) << p.transpose();
      if (p.x() < 19.0) {
        EXPECT_TRUE(on_segment) << p.transpose();
      }
      if (p.x() > 21.0) {
        EXPECT_TRUE(on_remainder) << p.transpose();
      }
      moved += on_segment;
      stationary += on_remainder;
    }
  }
  EXPECT_GT(moved, 20);
  EXPECT_GT(stationary, 10);
  EXPECT_GT(skin, 40);
  EXPECT_FALSE(tissue.node_sets.at(sets::kCut).empty());
  EXPECT_FALSE(tissue.node_sets.at(sets::kScanBoundary).empty());
}

TEST(TissueBoundary, ReleasesTissueNearTheSegmentAndFixesTheRest) {
  const mesh::VolumeMesh tissue = phantom_tissue(test::paper_boundary(4.0));
  const auto fixed = nodes_where(tissue, sets::kFixed);
  for (const std::int32_t node : tissue.node_sets.at(sets::kStationaryBone)) {
    const Vec3& p = tissue.nodes_L[std::size_t(node)];
    EXPECT_EQ(fixed.count(node) > 0, p.x() >= 24.0) << p.transpose();
  }
  for (const std::int32_t node : tissue.node_sets.at(sets::kCut)) EXPECT_TRUE(fixed.count(node));
  for (const std::int32_t node : tissue.node_sets.at(sets::kMobilizedSegment))
    EXPECT_FALSE(fixed.count(node));
  for (const std::int32_t node : tissue.node_sets.at(sets::kSkin)) EXPECT_FALSE(fixed.count(node));
}

TEST(TissueBoundary, FixesTheScanBoundaryOnlyIfRequired) {
  const auto prescribed = [](OuterBoundary edge) {
    BoundaryOptions options = test::paper_boundary();
    options.scan_boundary = edge;
    const mesh::VolumeMesh tissue = phantom_tissue(options);
    const auto fixed = nodes_where(tissue, sets::kFixed);
    const auto& nodes = tissue.node_sets.at(sets::kScanBoundary);
    return std::all_of(nodes.begin(), nodes.end(), [&](auto n) { return fixed.count(n) > 0; });
  };
  EXPECT_TRUE(prescribed(OuterBoundary::kFixed));
  EXPECT_FALSE(prescribed(OuterBoundary::kFree));
}

TEST(TissueBoundary, MayTouchTheSegmentOnlyFromInside) {
  const mesh::VolumeMesh tissue = phantom_tissue(test::paper_boundary(4.0));
  const auto& contact = tissue.face_sets.at(sets::kContact);
  EXPECT_GT(contact.size(), 50U);
  for (const mesh::Face& face : contact) {
    double lowest = 1e9;
    for (const std::int32_t node : nodes_of(face))
      lowest = std::min(lowest, tissue.nodes_L[std::size_t(node)].z());
    EXPECT_LT(lowest, 8.5);  // No face of the skin.
  }
}

TEST(TissueBoundary, DeepTissueIsNotSkinEvenIfALevelIsCutOffNearZero) {
  test::FacePhantom phantom = test::make_face_phantom();
  for (Index k = 12; k <= 15; ++k)  // An airway, 5 to 8 mm under the skin.
    for (Index j = 14; j <= 26; ++j)
      for (Index i = 6; i <= 18; ++i)
        phantom.soft_tissue_level.at(i, j, k) = float(-test::kPhantomNear_mm);
  const TissueDomain domain =
      make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, kOptions);
  const mesh::VolumeMesh tissue =
      test::find_phantom_boundary(mesh_tissue(domain, phantom.segment_L, kOptions).value(), domain,
                                  phantom, test::paper_boundary())
          .tissue;
  for (const std::int32_t node : tissue.node_sets.at(sets::kSkin))
    EXPECT_GT(tissue.nodes_L[std::size_t(node)].z(), test::kPhantomSkin_mm - 2.0);
  int in_airway = 0;
  for (const std::int32_t node : tissue.node_sets.at(sets::kFree))
    in_airway += std::abs(tissue.nodes_L[std::size_t(node)].z() - 13.5) < 3.0 ? 1 : 0;
  EXPECT_GT(in_airway, 20);
}

TEST(TissueBoundary, BrainExtendsTwoMillimetersForAnyVoxelSize) {
  const auto brain_nodes = [](double spacing_mm) {
    test::FacePhantom phantom = test::make_face_phantom();
    anatomy::LabelMap& labels =
        phantom.labels;  // The same brain, below z = 3 mm, in voxels of another size.
    labels.grid.spacing_mm = Vec3(spacing_mm, spacing_mm, spacing_mm);
    labels.values.clear();
    const auto count = Index(std::lround(40.0 / spacing_mm));
    labels.grid.size = {count, count, count};
    labels.grid.origin_L = Vec3::Constant(0.5 * spacing_mm);
    for (Index v = 0; v < labels.grid.voxel_count(); ++v)
      labels.values.push_back(double(v / (count * count) + 1) * spacing_mm <= 6.5
                                  ? anatomy::Tissue::kBrain
                                  : anatomy::Tissue::kSoftTissue);
    phantom.segment_L = test::make_box({0.0, 0.0, 0.0}, {20.0, 40.0, 5.0});
    phantom.remainder_L = test::make_box({20.0, 0.0, 0.0}, {40.0, 40.0, 5.0});
    const TissueDomain domain =
        make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, kOptions);
    static const mesh::VolumeMesh bare = mesh_tissue(domain, phantom.segment_L, kOptions).value();
    return test::find_phantom_boundary(bare, domain, phantom, test::paper_boundary())
        .tissue.node_sets.at(sets::kBrain);
  };
  const auto fine = brain_nodes(0.5);
  EXPECT_GT(fine.size(), 50U);  // 6.5 mm and 2 mm reach 8 mm.
  EXPECT_EQ(brain_nodes(6.5 / 4.0), fine);
}

TEST(TissueBoundary, TissueOnTheBrainIsFixed) {
  test::FacePhantom phantom = test::make_face_phantom();
  for (anatomy::Tissue& label : phantom.labels.values)
    if (label == anatomy::Tissue::kBone) label = anatomy::Tissue::kBrain;
  // Without bone nearby, the lower side borders the brain alone.
  phantom.segment_L = test::make_box({0.0, 0.0, 0.0}, {20.0, 40.0, 5.0});
  phantom.remainder_L = test::make_box({20.0, 0.0, 0.0}, {40.0, 40.0, 5.0});
  const TissueDomain domain =
      make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, kOptions);
  const mesh::VolumeMesh tissue =
      test::find_phantom_boundary(mesh_tissue(domain, phantom.segment_L, kOptions).value(), domain,
                                  phantom, test::paper_boundary(0.0))
          .tissue;
  const auto fixed = nodes_where(tissue, sets::kFixed);
  EXPECT_GT(tissue.node_sets.at(sets::kBrain).size(), 50U);
  for (const std::int32_t node : tissue.node_sets.at(sets::kBrain)) EXPECT_TRUE(fixed.count(node));
}

}  // namespace
}  // namespace lefort::predict::test_tissue_boundary
