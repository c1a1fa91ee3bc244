#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/assign_regions.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/tissue_materials.h>

#include <gtest/gtest.h>

#include <numbers>

#include "support/face_phantom.h"
#include "support/paper_boundary.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_assign_regions {
namespace {

/// A small tetrahedron whose centroid is `at_L`.
void add_tet(mesh::VolumeMesh& mesh, const Vec3& at_L, std::int32_t region) {
  for (const Vec3& corner : {Vec3(-0.1, -0.1, -0.1), Vec3(0.3, -0.1, -0.1), Vec3(-0.1, 0.3, -0.1),
                             Vec3(-0.1, -0.1, 0.3)}) {
    mesh.blocks[0].nodes.push_back(std::int32_t(mesh.nodes_L.size()));
    mesh.nodes_L.push_back(at_L + corner);
  }
  mesh.blocks[0].region.push_back(region);
}

/// Voxels of 0.5 mm; air of two kinds ends at x = 4.75 mm and begins at x = 15.25 mm.
anatomy::LabelMap air_on_both_sides() {
  anatomy::LabelMap labels;
  labels.grid.size = {41, 9, 9};
  labels.grid.spacing_mm = Vec3::Constant(0.5);
  for (Index v = 0; v < labels.grid.voxel_count(); ++v) {
    const double x_mm = 0.5 * double(v % 41);
    labels.values.push_back(x_mm < 4.75    ? anatomy::Tissue::kAirway
                            : x_mm > 15.25 ? anatomy::Tissue::kSinus
                                           : anatomy::Tissue::kSoftTissue);
  }
  return labels;
}

TEST(AssignMucosa, IsDeepTissueNearAir) {
  mesh::VolumeMesh mesh;
  mesh.blocks.push_back({mesh::ElementShape::kTet4, {}, {}});
  std::vector<std::int32_t> wanted;
  for (const double x_mm : {5.0, 6.5, 7.0, 10.0, 13.0, 13.5, 15.0}) {
    add_tet(mesh, {x_mm, 2.0, 2.0}, regions::kDeepTissue);
    // 2 mm from 4.75 and from 15.25.
    wanted.push_back(x_mm < 6.75 || x_mm > 13.25 ? regions::kMucosa : regions::kDeepTissue);
  }
  add_tet(mesh, {5.0, 2.0, 2.0}, regions::kSkin);
  wanted.push_back(regions::kSkin);
  EXPECT_EQ(assign_mucosa(mesh, air_on_both_sides(), 2.0).blocks[0].region, wanted);
}

const Vec3 kBall_L(18.0, 20.0, 14.0);  ///< In the middle of the phantom's soft tissue.
constexpr double kBall_mm = 4.5;

/// The phantom's labels with a ball of muscle in its tissue.
anatomy::LabelMap with_ball(anatomy::LabelMap labels) {
  for (Index k = 0; k < labels.grid.size[2]; ++k)
    for (Index j = 0; j < labels.grid.size[1]; ++j)
      for (Index i = 0; i < labels.grid.size[0]; ++i)
        if ((labels.grid.point_L(Vec3(double(i), double(j), double(k))) - kBall_L).norm() <
            kBall_mm)
          labels.at(i, j, k) = anatomy::Tissue::kMuscle;
  return labels;
}

TEST(AssignMuscle, IsAsLargeAsThePaintedBall) {
  const test::FacePhantom phantom = test::make_face_phantom();
  const TissueOptions options{.element_size_mm = 1.8,
                              .far_element_size_mm = 1.8,
                              .margin_mm = 15.0,
                              .muscle = MuscleOptions{0.06, 0.45}};
  const TissueDomain domain =
      make_tissue_domain(phantom.soft_tissue_level, phantom.grid, phantom.segment_L, options);
  const mesh::VolumeMesh plain = mesh_tissue(domain, phantom.segment_L, options).value();
  const mesh::VolumeMesh named = assign_muscle(plain, with_ball(phantom.labels));
  EXPECT_EQ(named.nodes_L, plain.nodes_L);
  EXPECT_EQ(named.blocks[0].nodes, plain.blocks[0].nodes);
  for (Index e = 0; e < named.blocks[0].element_count(); ++e) {
    Vec3 centroid_L = Vec3::Zero();
    for (int n = 0; n < 4; ++n)
      centroid_L += named.nodes_L[std::size_t(named.blocks[0].element(e)[n])] / 4.0;
    const double from_border_mm = (centroid_L - kBall_L).norm() - kBall_mm;
    if (from_border_mm < -0.9) {  // Half a voxel's diagonal.
      EXPECT_EQ(named.blocks[0].region[std::size_t(e)], regions::kMuscle);
    } else if (from_border_mm > 0.9) {
      EXPECT_EQ(named.blocks[0].region[std::size_t(e)], regions::kDeepTissue);
    }
  }
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi * kBall_mm * kBall_mm * kBall_mm;
  const auto reported = regions_and_sizes(named, options);
  ASSERT_EQ(reported.size(), 2U);
  EXPECT_EQ(reported[1].name, "muscle");
  EXPECT_GT(reported[1].size.elements, 200);
  EXPECT_NEAR(reported[1].size.volume_mm3, ball_mm3, 0.04 * ball_mm3);
  EXPECT_EQ(reported[0].size.elements + reported[1].size.elements, named.element_count());
  EXPECT_NE(describe_regions(named, options).find("; muscle "), std::string::npos);
}

TEST(AssignMuscle, SkinComesBeforeMuscleAndMuscleBeforeMucosa) {
  anatomy::LabelMap labels = air_on_both_sides();
  for (anatomy::Tissue& label : labels.values)
    if (label == anatomy::Tissue::kSoftTissue) label = anatomy::Tissue::kMuscle;
  mesh::VolumeMesh mesh;
  mesh.blocks.push_back({mesh::ElementShape::kTet4, {}, {}});
  add_tet(mesh, {5.3, 2.0, 2.0}, regions::kDeepTissue);  // Muscle, and near air.
  add_tet(mesh, {4.3, 2.0, 2.0}, regions::kDeepTissue);  // In the air's voxels: mucosa.
  add_tet(mesh, {10.0, 2.0, 2.0}, regions::kSkin);
  add_tet(mesh, {10.0, 2.0, 40.0}, regions::kDeepTissue);  // Beyond the scan.
  const std::vector<std::int32_t> wanted{regions::kMuscle, regions::kMucosa, regions::kSkin,
                                         regions::kDeepTissue};
  EXPECT_EQ(assign_mucosa(assign_muscle(mesh, labels), labels, 2.0).blocks[0].region, wanted);
}

/// In stretched tissue a stiffer ball strains less than the tissue would:
/// by 1 / (1 + b (k - 1)) in an infinite body, with k the ratio of the stiffnesses and
/// b = 2 (4 - 5 nu) / (15 (1 - nu)) (Eshelby 1957, for isochoric strain).
TEST(AssignMuscle, AStiffMuscleStrainsLessInAPrediction) {
  constexpr double kRatio = 8.0, kSide_mm = 20.0, kRadius_mm = 4.0;
  const Vec3 center_L = Vec3::Constant(0.5 * kSide_mm);
  FaceModel model = test::block_on_slab();
  model.tissue = test::box_mesh({.cells = {16, 16, 16},
                                 .size_mm = Vec3::Constant(kSide_mm),
                                 .shape = mesh::ElementShape::kHex8});
  auto& node_sets = model.tissue.node_sets;
  node_sets[sets::kMobilizedSegment] = node_sets.at("z0");
  node_sets[sets::kFixed] = node_sets.at("z1");
  model.tissue.face_sets[sets::kContact] = {};
  anatomy::LabelMap labels;
  labels.grid.size = {41, 41, 41};
  labels.grid.spacing_mm = Vec3::Constant(0.5);
  for (Index v = 0; v < labels.grid.voxel_count(); ++v) {
    const Vec3 p_L =
        labels.grid.point_L(Vec3(double(v % 41), double(v / 41 % 41), double(v / 1681)));
    labels.values.push_back((p_L - center_L).norm() < kRadius_mm ? anatomy::Tissue::kMuscle
                                                                 : anatomy::Tissue::kSoftTissue);
  }
  model.tissue = assign_muscle(std::move(model.tissue), labels);
  // The slope of vertical displacement over height inside the ball, by least squares.
  const auto strain_of = [&](double young_mpa) {
    PredictionOptions options;
    options.boundary = test::bonded_boundary();
    options.tissue.muscle = MuscleOptions{young_mpa, options.tissue.poisson};
    const auto found = predict_face(model, {test::straight({0.0, 0.0, -0.2}, 1)}, options).value();
    EXPECT_TRUE(found.converged());
    double zu = 0.0, zz = 0.0;
    for (std::size_t n = 0; n < model.tissue.nodes_L.size(); ++n) {
      const Vec3 p_mm = model.tissue.nodes_L[n] - center_L;
      if (p_mm.norm() > 0.7 * kRadius_mm) continue;
      zu += p_mm.z() * found.steps.back().displacement_mm[n].z();
      zz += p_mm.z() * p_mm.z();
    }
    return zu / zz;
  };
  const TissueOptions soft;
  const double b = 2.0 * (4.0 - 5.0 * soft.poisson) / (15.0 * (1.0 - soft.poisson));
  const double eshelby = 1.0 / (1.0 + b * (kRatio - 1.0));
  EXPECT_NEAR(strain_of(kRatio * soft.young_mpa) / strain_of(soft.young_mpa), eshelby,
              0.15 * eshelby);
}

TEST(AssignMuscle, HasItsOwnMaterial) {
  TissueOptions options;
  EXPECT_FALSE(materials_of(options)->contains(regions::kMuscle));
  options.muscle = MuscleOptions{.young_mpa = 0.06, .poisson = 0.4};
  EXPECT_TRUE(materials_of(options)->contains(regions::kMuscle));
  options.muscle->poisson = 0.5;
  EXPECT_FALSE(materials_of(options));
}

TEST(AssignMucosa, HasItsOwnMaterial) {
  TissueOptions options;
  EXPECT_FALSE(materials_of(options)->contains(regions::kMucosa));
  options.mucosa = MucosaOptions{.thickness_mm = 2.0, .young_mpa = 0.03, .poisson = 0.4};
  EXPECT_TRUE(materials_of(options)->contains(regions::kMucosa));
  options.mucosa->poisson = 0.5;
  EXPECT_FALSE(materials_of(options));
}

}  // namespace
}  // namespace lefort::predict::test_assign_regions
