#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/layer_thickness.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/skin_faces.h>
#include <lefort/predict/tissue_boundary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "support/face_phantom.h"
#include "support/paper_boundary.h"

namespace lefort::predict::test_tissue_skin {
namespace {

constexpr double kCapture_mm = 0.8;

TissueOptions options() {
  TissueOptions options{.element_size_mm = 3.0, .far_element_size_mm = 3.0, .margin_mm = 15.0};
  options.skin = SkinOptions{.thickness_mm = 1.5, .layers = 2};
  return options;
}

struct Case {
  test::FacePhantom phantom = test::make_face_phantom();
  TissueDomain domain =
      make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, options());
  mesh::VolumeMesh mesh = mesh_tissue_and_skin(domain, phantom.skin_L, phantom.segment_L,
                                               phantom.remainder_L, options(), kCapture_mm)
                              .value();
};

const Case& mixed() {
  static const Case the_case;
  return the_case;
}

/// From the scan boundary, 0.5, to the end of the margin, 35; 39 deep, 12 high.
double phantom_volume_mm3() { return (35.0 - 0.5) * 39.0 * 12.0; }

TEST(TissueSkin, IsALayerOfWedgesOfItsThickness) {
  const mesh::VolumeMesh& mesh = mixed().mesh;
  const mesh::MeshQuality quality = mesh::measure_quality(mesh);
  EXPECT_NEAR(quality.volume_mm3, phantom_volume_mm3(), 0.02 * phantom_volume_mm3());
  EXPECT_GE(quality.min_scaled_jacobian, kMinJacobian);
  EXPECT_TRUE(quality.inverted.empty());

  const mesh::VolumeMesh named =
      test::find_phantom_boundary(mesh, mixed().domain, mixed().phantom, test::paper_boundary(4.0))
          .tissue;
  const auto measure = [&](const std::vector<mesh::Face>& faces) {
    return mesh::layer_thickness_statistics(named, regions::kSkin, faces, 2,
                                            options().skin->thickness_mm);
  };
  const std::vector<mesh::Face>& skin = named.face_sets.at(sets::kSkin);
  EXPECT_GT(measure(skin).covered_fraction,
            0.75);  // The rest is next to bevels along the cut planes.
  std::vector<mesh::Face> middle;
  std::copy_if(skin.begin(), skin.end(), std::back_inserter(middle), [&](const mesh::Face& face) {
    const auto nodes = nodes_of(face);
    return std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t node) {
      const Vec3& p = named.nodes_L[std::size_t(node)];
      return p.x() > 8.0 && p.x() < 27.0 && p.y() > 8.0 && p.y() < 32.0;
    });
  });
  const mesh::LayerThickness layer = measure(middle);
  EXPECT_GT(layer.area_mm2, 300.0);
  EXPECT_EQ(layer.covered_fraction, 1.0);
  EXPECT_NEAR(layer.mean_mm, 1.5, 0.01);
  EXPECT_GT(layer.full_thickness_fraction, 0.98);
}

TEST(TissueSkin, DoesNotChangeTheSetsOfTheBoundary) {
  const mesh::VolumeMesh tissue =
      test::find_phantom_boundary(mixed().mesh, mixed().domain, mixed().phantom,
                                  test::paper_boundary(4.0))
          .tissue;
  const auto is_in = [&](const char* set, std::int32_t node) {
    const auto& nodes = tissue.node_sets.at(set);
    return std::binary_search(nodes.begin(), nodes.end(), node);
  };
  int skin = 0, cut = 0;
  for (const std::int32_t node : tissue.node_sets.at("boundary")) {
    const Vec3& p = tissue.nodes_L[std::size_t(node)];
    const bool is_inside_sides = p.x() > 2.0 && p.x() < 33.0 && p.y() > 2.0 && p.y() < 38.0;
    if (is_inside_sides && p.z() > 19.9) {
      EXPECT_TRUE(is_in(sets::kSkin, node)) << p.transpose();
      ++skin;
    }
    if (std::abs(p.x() - 35.0) < 0.01) {  // Includes the side faces of the layer.
      EXPECT_TRUE(is_in(sets::kCut, node)) << p.transpose();
      EXPECT_TRUE(is_in(sets::kFixed, node)) << p.transpose();
      cut += int(p.z() > 18.0 && p.z() < 19.9);
    }
  }
  EXPECT_GT(skin, 40);
  EXPECT_GT(cut, 5);  // Includes nodes at the bottom of the layer and between its layers.
  // Nodes under the skin are boundary only in a cut plane.
  for (const std::int32_t node : tissue.node_sets.at(sets::kFree)) {
    const Vec3& p = tissue.nodes_L[std::size_t(node)];
    EXPECT_FALSE(p.x() > 2.0 && p.x() < 33.0 && p.y() > 2.0 && p.y() < 38.0) << p.transpose();
  }
  for (const mesh::Face& face : tissue.face_sets.at(sets::kContact))
    EXPECT_EQ(face.shape, mesh::FaceShape::kTri3);
}

TEST(TissueSkin, ReportsThatThereIsNoSkin) {
  const Case& it = mixed();
  const auto far_skin = test::make_box({200.0, 0.0, 0.0}, {240.0, 40.0, 20.0});
  const auto bare = mesh_tissue_and_skin(it.domain, far_skin, it.phantom.segment_L,
                                         it.phantom.remainder_L, options(), kCapture_mm);
  EXPECT_EQ(bare.error().code, ErrorCode::kAnatomyMissing);
}

TEST(SkinFaces, AreNeitherBoneNorCutFaces) {
  const Case& it = mixed();
  TissueOptions plain = options();
  plain.skin.reset();
  const mesh::VolumeMesh tets = mesh_tissue(it.domain, it.phantom.segment_L, plain).value();
  const auto faces = skin_faces(tets, it.domain, it.phantom.skin_L, it.phantom.segment_L,
                                it.phantom.remainder_L, kCapture_mm);
  double area_mm2 = 0.0;
  for (const mesh::Face& face : faces) {
    const auto at = [&](std::size_t n) { return tets.nodes_L[std::size_t(face.nodes[n])]; };
    const Vec3 area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0));
    EXPECT_GT(area.normalized().z(), 0.5);
    area_mm2 += area.norm();
  }
  EXPECT_NEAR(area_mm2, (35.0 - 0.5) * 39.0, 0.03 * 35.0 * 39.0);
}

/// Mean edge of elements with a node within 4 mm of `at_L`.
double edge_mm_near(const mesh::VolumeMesh& mesh, const Vec3& at_L) {
  double sum = 0.0;
  int count = 0;
  const mesh::ElementBlock& block = mesh.blocks[0];
  for (Index e = 0; e < block.element_count(); ++e) {
    const auto at = [&](int n) { return mesh.nodes_L[std::size_t(block.element(e)[n])]; };
    bool is_near = false;
    for (int n = 0; n < 4; ++n) is_near |= (at(n) - at_L).norm() < 4.0;
    for (int a = 0; is_near && a < 4; ++a)
      for (int b = 0; b < a; ++b, ++count) sum += (at(a) - at(b)).norm();
  }
  return sum / count;
}

TEST(TissueSize, IsFinerAtLipsAndNose) {
  const test::FacePhantom& phantom = mixed().phantom;
  TissueOptions plain{.element_size_mm = 4.0, .far_element_size_mm = 4.0, .margin_mm = 15.0};
  const auto made = [&](const TissueOptions& options) {
    return mesh_tissue(mixed().domain, phantom.segment_L, options).value();
  };
  const Vec3 lip_L(25.0, 28.0, 19.0);
  const mesh::VolumeMesh even = made(plain);
  TissueOptions by_landmark = plain;
  by_landmark.face = FaceSize{1.5, {lip_L}};
  const mesh::VolumeMesh finer = made(by_landmark);
  EXPECT_LT(edge_mm_near(finer, lip_L), 0.65 * edge_mm_near(even, lip_L));
  // Without landmarks, at the most anterior point, here on the side at y = 0.5.
  TissueOptions by_rule = plain;
  by_rule.face = FaceSize{1.5, {}};
  const mesh::VolumeMesh front = made(by_rule);
  const auto count_in_front = [](const mesh::VolumeMesh& mesh) {
    return std::count_if(mesh.nodes_L.begin(), mesh.nodes_L.end(),
                         [](const Vec3& p) { return p.y() < 8.0; });
  };
  EXPECT_GT(double(count_in_front(front)), 1.5 * double(count_in_front(even)));
}

}  // namespace
}  // namespace lefort::predict::test_tissue_skin
