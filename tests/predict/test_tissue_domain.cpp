#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/tissue_domain.h>

#include <gtest/gtest.h>

#include "support/face_phantom.h"

namespace lefort::predict::test_tissue_domain {
namespace {

TissueDomain phantom_domain(double margin_mm) {
  test::FacePhantom phantom = test::make_face_phantom();
  return make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L,
                            {.margin_mm = margin_mm});
}

TEST(TissueDomain, IsSoftTissueWithinTheMarginAndTheScan) {
  const TissueDomain domain = phantom_domain(6.0);
  EXPECT_GT(domain.level({10.0, 20.0, 11.0}), 0.0);  // tissue over the segment
  EXPECT_LT(domain.level({10.0, 20.0, 5.0}), 0.0);   // bone
  EXPECT_LT(domain.level({10.0, 20.0, 22.0}), 0.0);  // air
  EXPECT_GT(domain.level({25.0, 20.0, 11.0}), 0.0);  // within the margin
  EXPECT_LT(domain.level({27.0, 20.0, 11.0}), 0.0);  // beyond it
  EXPECT_LT(domain.level({10.0, 0.2, 11.0}), 0.0);   // scan boundary
  EXPECT_LT(domain.level({1e6, 0.0, 0.0}), 0.0);
}

TEST(TissueDomain, DistinguishesCutFromScanBoundary) {
  const TissueDomain domain = phantom_domain(6.0);
  EXPECT_NEAR(domain.distance_to_cut({26.0, 20.0, 11.0}), 0.0, 1e-12);
  EXPECT_NEAR(domain.distance_to_cut({10.0, 20.0, 11.0}), 3.0, 1e-12);  // the box's top, z = 14
  EXPECT_NEAR(domain.distance_to_scan_boundary({10.0, 0.5, 11.0}), 0.0, 1e-12);
  EXPECT_NEAR(domain.distance_to_scan_boundary({10.0, 3.0, 11.0}), 2.5, 1e-12);
}

TEST(MeshTissue, FillsTheDomainFinerNearTheSegment) {
  test::FacePhantom phantom = test::make_face_phantom();
  const TissueOptions options{
      .element_size_mm = 2.0, .far_element_size_mm = 5.0, .margin_mm = 30.0};
  const TissueDomain domain =
      make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, options);
  const auto mesh = mesh_tissue(domain, phantom.segment_L, options).value();
  ASSERT_GT(mesh.element_count(), 500);
  double volume_mm3 = 0.0;
  for (Index e = 0; e < mesh.blocks[0].element_count(); ++e) {
    const std::int32_t* n = mesh.blocks[0].element(e);
    const auto at = [&](int c) -> const Vec3& { return mesh.nodes_L[std::size_t(n[c])]; };
    volume_mm3 += (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) / 6.0;
  }
  EXPECT_NEAR(volume_mm3, 39.0 * 39.0 * 12.0, 0.02 * 39.0 * 39.0 * 12.0);
}

}  // namespace
}  // namespace lefort::predict::test_tissue_domain
