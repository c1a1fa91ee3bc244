#include <lefort/contact/bone_overlap.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/field_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/server/case/overlap_service.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::server::test_overlap_service {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kBand_mm = 3.0;

/// A stationary box, and two balls that move, as files of cut_plan().
class OverlapServiceOf : public testing::Test {
 protected:
  void SetUp() override {
    json bones = json::array();
    const auto add = [&](const std::string& name, const geometry::TriangleMesh& surface) {
      const std::string file = (name.empty() ? "remainder" : "segment_" + name);
      const auto field =
          field::build_distance_field(surface, {.resolution = 64, .band_mm = kBand_mm});
      ASSERT_TRUE(field && io::write_surface(folder_ / (file + ".vtp"), surface) &&
                  io::write_field(folder_ / (file + ".field"), *field));
      surfaces_.push_back(surface);
      fields_.push_back(std::make_shared<const field::DistanceField>(*field));
      bones.push_back({{"name", name}, {"surface", file + ".vtp"}, {"field", file + ".field"}});
    };
    geometry::TriangleMesh beside = test::make_icosphere(5.0, 3);
    for (Vec3& v : beside.vertices) v += Vec3(20.0, 0.0, 0.0);
    add("a", test::make_icosphere(6.0, 3));
    add("b", beside);
    add("", test::make_box({-10.0, -10.0, -30.0}, {30.0, 10.0, -8.0}));
    write({{"bones", bones}});
  }
  void write(const json& document) {
    ASSERT_TRUE(io::write_text(folder_ / "cut.json", document.dump()));
  }
  [[nodiscard]] Result<OverlapService> read() const {
    return OverlapService::read(folder_.path(), folder_.path());
  }
  /// As in `lefort plan check`.
  [[nodiscard]] contact::BoneOverlap overlap(std::size_t a, const RigidTransform& X_LA,
                                             std::size_t b, const RigidTransform& X_LB) const {
    const auto bone = [&](std::size_t k, const RigidTransform& pose) {
      return contact::SolidBone{
          &surfaces_[k],
          {contact::field_distance_query(fields_[k], contact::DetectionMethod::kTrilinear).value(),
           pose}};
    };
    return contact::measure_overlap(bone(a, X_LA), bone(b, X_LB), 1.0);
  }

  test::TemporaryFolder folder_;
  std::vector<geometry::TriangleMesh> surfaces_;
  std::vector<std::shared_ptr<const field::DistanceField>> fields_;
};

RigidTransform pose(const Vec3& shift_mm, double turn_rad) {
  RigidTransform X = RigidTransform::Identity();
  X.linear() = Eigen::AngleAxisd(turn_rad, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  X.translation() = shift_mm;
  return X;
}

TEST_F(OverlapServiceOf, ReportsTheDepthsThatAPlanCheckFinds) {
  const OverlapService live = read().value();
  int deep = 0;
  for (const auto& [shift_mm, turn] : std::vector<std::pair<Vec3, double>>{{{0, 0, 0}, 0.0},
                                                                           {{0, 0, -3.0}, 0.3},
                                                                           {{9.5, 0, 0}, 1.0},
                                                                           {{9.5, 0, -3}, 0.1},
                                                                           {{0, 0, -8}, 0.2},
                                                                           {{500, 0, 0}, 0.0}}) {
    const RigidTransform X_LA = pose(shift_mm, turn), rest = RigidTransform::Identity();
    const auto depths = live.depths({{"a", X_LA}}).value();
    ASSERT_EQ(depths.segments.size(), 1U);
    ASSERT_EQ(depths.depth_mm.size(), surfaces_[0].vertices.size());
    const auto in_b = overlap(0, X_LA, 1, rest), in_stationary = overlap(0, X_LA, 2, rest);
    double deepest_mm = 0.0;
    for (std::size_t v = 0; v < depths.depth_mm.size(); ++v) {
      const double wanted_mm = std::max(in_b.depth_mm[v], in_stationary.depth_mm[v]);
      EXPECT_NEAR(depths.depth_mm[v], wanted_mm, 1e-4);  // Files hold single precision.
      deepest_mm = std::max(deepest_mm, depths.depth_mm[v]);
    }
    EXPECT_EQ(depths.deepest_mm, deepest_mm);
    EXPECT_EQ(depths.depth_is_lower_bound, deepest_mm >= kBand_mm - 1e-9) << deepest_mm;
    if (deepest_mm > 0.0) ++deep;
  }
  EXPECT_GE(deep, 3);
}

TEST_F(OverlapServiceOf, MovesSegmentsTogether) {
  const OverlapService live = read().value();
  // Both go the same way: they stay apart.
  const RigidTransform away = pose({0.0, 0.0, 40.0}, 0.0);
  const auto depths = live.depths({{"a", away}, {"b", away}}).value();
  ASSERT_EQ(depths.segments.size(), 2U);
  EXPECT_EQ(depths.depth_mm.size(), surfaces_[0].vertices.size() + surfaces_[1].vertices.size());
  EXPECT_EQ(depths.deepest_mm, 0.0);
}

TEST_F(OverlapServiceOf, RejectsUnknownSegments) {
  const OverlapService live = read().value();
  for (const char* name : {"c", "", "remainder"})
    EXPECT_FALSE(live.depths({{name, RigidTransform::Identity()}})) << name;
}

TEST_F(OverlapServiceOf, RejectsADamagedDocumentAndPathsInIt) {
  for (const char* text :
       {"", "{}", "[]", R"({"bones":1})", R"({"bones":[1]})", R"({"bones":[{"name":"a"}]})",
        R"({"bones":[{"name":"a","surface":"../segment_a.vtp","field":"segment_a.field"}]})",
        R"({"bones":[{"name":"a","surface":"/etc/passwd","field":"segment_a.field"}]})",
        R"({"bones":[{"name":"a","surface":"segment_a.vtp","field":".."}]})",
        R"({"bones":[{"name":"a","surface":"segment_a.vtp","field":"nothing.field"}]})"}) {
    std::ofstream(folder_ / "cut.json") << text;
    EXPECT_FALSE(read()) << text;
  }
}

}  // namespace
}  // namespace lefort::server::test_overlap_service
