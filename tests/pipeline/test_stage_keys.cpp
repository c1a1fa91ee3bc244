#include <lefort/pipeline/cache/stage_keys.h>

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "support/shapes.h"

namespace lefort::pipeline::test_stage_keys {
namespace {

const geometry::TriangleMesh kBox = test::make_box(Vec3::Zero(), Vec3::Ones());
const geometry::TriangleMesh kOtherBox = test::make_box(Vec3::Zero(), Vec3(1.0, 1.0, 2.0));

anatomy::LabelMap labels(anatomy::Tissue tissue) {
  anatomy::LabelMap map;
  map.grid.size = {1, 1, 1};
  map.values = {tissue};
  return map;
}

TEST(StageKeys, LabelsDependOnTheScanAndEveryOption) {
  const std::set<std::string> keys{labels_key("scan", {}),
                                   labels_key("other", {}),
                                   labels_key("scan", {.bone_hu = 300.0}),
                                   labels_key("scan", {.skin_hu = -200.0}),
                                   labels_key("scan", {.min_bone_ml = 0.3}),
                                   labels_key("scan", {.nostril_radius_mm = 4.0}),
                                   labels_key("scan", {.ostium_radius_mm = 1.0}),
                                   labels_key("scan", {.min_air_ml = 0.1})};
  EXPECT_EQ(keys.size(), 8U);
  EXPECT_EQ(labels_key("scan", {}), labels_key("scan", {}));
}

TEST(StageKeys, AFieldDependsOnTheBoneAndEveryOption) {
  const std::set<std::string> keys{field_key(kBox, {}),
                                   field_key(kOtherBox, {}),
                                   field_key(kBox, {.resolution = 128}),
                                   field_key(kBox, {.band_mm = 2.0}),
                                   field_key(kBox, {.tolerance_mm = 0.01}),
                                   field_key(kBox, {.margin_mm = 1.0}),
                                   field_key(kBox, {.method = field::FieldMethod::kHybrid}),
                                   field_key(kBox, {.smooth = true})};
  EXPECT_EQ(keys.size(), 8U);
}

TEST(StageKeys, TissueDependsOnAllThatShapesItAndNotOnItsStiffness) {
  const auto key =
      [](const std::string& scan, anatomy::Tissue tissue, const anatomy::LevelOptions& levels,
         const predict::TissueOptions& options, const geometry::TriangleMesh& segment_L = kBox,
         const geometry::TriangleMesh& remainder_L = kBox, double contact_snap_mm = 0.8) {
        return tissue_key(scan, labels(tissue), levels, segment_L, remainder_L, options,
                          contact_snap_mm);
      };
  constexpr auto kBone = anatomy::Tissue::kBone;
  const std::set<std::string> keys{key("scan", kBone, {}, {}),
                                   key("other", kBone, {}, {}),
                                   key("scan", anatomy::Tissue::kBrain, {}, {}),
                                   key("scan", kBone, {.bone_hu = 300.0}, {}),
                                   key("scan", kBone, {.skin_hu = -200.0}, {}),
                                   key("scan", kBone, {.bone_smoothing_mm = 1.0}, {}),
                                   key("scan", kBone, {.skin_smoothing_mm = 0.5}, {}),
                                   key("scan", kBone, {.thinnest_tissue_mm = 2.0}, {}),
                                   key("scan", kBone, {.nostril_depth_mm = 4.0}, {}),
                                   key("scan", kBone, {}, {.element_size_mm = 3.0}),
                                   key("scan", kBone, {}, {.far_element_size_mm = 6.0}),
                                   key("scan", kBone, {}, {.margin_mm = 20.0}),
                                   key("scan", kBone, {}, {}, kOtherBox)};
  EXPECT_EQ(keys.size(), 13U);
  EXPECT_EQ(key("scan", kBone, {}, {.young_mpa = 1.0}), key("scan", kBone, {}, {}));
  EXPECT_EQ(key("scan", kBone, {}, {}, kBox, kOtherBox, 1.0), key("scan", kBone, {}, {}));

  const auto with = [](const predict::SkinOptions& skin) {
    predict::TissueOptions options;
    options.skin = skin;
    return options;
  };
  const std::set<std::string> of_skin{key("scan", kBone, {}, {}),
                                      key("scan", kBone, {}, with({})),
                                      key("scan", kBone, {}, with({.thickness_mm = 2.0})),
                                      key("scan", kBone, {}, with({.layers = 3})),
                                      key("scan", kBone, {}, with({}), kBox, kOtherBox),
                                      key("scan", kBone, {}, with({}), kBox, kBox, 1.0)};
  EXPECT_EQ(of_skin.size(), 6U);
  EXPECT_EQ(key("scan", kBone, {}, with({.young_mpa = 1.0})), key("scan", kBone, {}, with({})));

  const auto face = [](const predict::FaceSize& size) {
    predict::TissueOptions options;
    options.face = size;
    return options;
  };
  const std::set<std::string> of_face{key("scan", kBone, {}, {}),
                                      key("scan", kBone, {}, face({2.0, {}})),
                                      key("scan", kBone, {}, face({1.5, {}})),
                                      key("scan", kBone, {}, face({2.0, {Vec3(1, 2, 3)}}))};
  EXPECT_EQ(of_face.size(), 4U);
  // Mucosa is named in the mesh when that is there.
  predict::TissueOptions mucosa;
  mucosa.mucosa = predict::MucosaOptions{2.0, 0.03, 0.4};
  EXPECT_EQ(key("scan", kBone, {}, mucosa), key("scan", kBone, {}, {}));
  predict::TissueOptions muscle;
  muscle.muscle = predict::MuscleOptions{0.03, 0.4};
  EXPECT_EQ(key("scan", kBone, {}, muscle), key("scan", kBone, {}, {}));
}

}  // namespace
}  // namespace lefort::pipeline::test_stage_keys
