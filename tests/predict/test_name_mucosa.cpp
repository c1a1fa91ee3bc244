#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/name_mucosa.h>
#include <lefort/predict/tissue_materials.h>

#include <gtest/gtest.h>

namespace lefort::predict {
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

TEST(NameMucosa, IsWhatLiesNearTheAirInsideButNotSkin) {
  mesh::VolumeMesh mesh;
  mesh.blocks.push_back({mesh::ElementShape::kTet4, {}, {}});
  std::vector<std::int32_t> wanted;
  for (const double x_mm : {5.0, 6.5, 7.0, 10.0, 13.0, 13.5, 15.0}) {
    add_tet(mesh, {x_mm, 2.0, 2.0}, regions::kInside);
    // 2 mm from 4.75 and from 15.25.
    wanted.push_back(x_mm < 6.75 || x_mm > 13.25 ? regions::kMucosa : regions::kInside);
  }
  add_tet(mesh, {5.0, 2.0, 2.0}, regions::kSkin);
  wanted.push_back(regions::kSkin);
  EXPECT_EQ(name_mucosa(mesh, air_on_both_sides(), 2.0).blocks[0].region, wanted);
}

TEST(NameMucosa, HasAMaterialOfItsOwn) {
  TissueOptions options;
  EXPECT_FALSE(materials_of(options)->contains(regions::kMucosa));
  options.mucosa = MucosaOptions{.thickness_mm = 2.0, .young_mpa = 0.03, .poisson = 0.4};
  EXPECT_TRUE(materials_of(options)->contains(regions::kMucosa));
  options.mucosa->poisson = 0.5;
  EXPECT_FALSE(materials_of(options));
}

}  // namespace
}  // namespace lefort::predict
