#include <lefort/dental/cut_arch.h>
#include <lefort/dental/find_occlusion.h>
#include <lefort/dental/renumber_teeth.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dental/arch.h"

namespace lefort::dental {
namespace {

/// Crowns along the parabola of make_arch(), 17 to 27.
std::map<int, Vec3> crowns() {
  std::map<int, Vec3> crowns_L;
  for (int n = -7; n <= 7; ++n) {
    if (n == 0) continue;
    const double t = (n - (n > 0 ? 0.5 : -0.5)) / 7.0;
    crowns_L[n < 0 ? 10 - n : 20 + n] = Vec3(27.0 * t, 42.0 * t * t, 4.0);
  }
  return crowns_L;
}

TEST(CutArch, divides_between_teeth) {
  const auto arch = test::make_arch({}, true);
  const std::array<std::array<int, 2>, 2> cuts{{{23, 22}, {12, 13}}};
  const auto pieces = cut_arch(arch, crowns(), cuts);
  ASSERT_TRUE(pieces) << pieces.error().message;
  ASSERT_EQ(pieces->size(), 3U);
  std::size_t all = 0;
  for (const auto& piece : *pieces) all += piece.triangles.size();
  EXPECT_EQ(all, arch.triangles.size());
  // Right, middle, left; cuts near x = -+27 * 2 / 7.
  for (const Vec3& p : (*pieces)[0].vertices) EXPECT_LT(p.x(), -3.0);
  for (const Vec3& p : (*pieces)[1].vertices) EXPECT_LT(std::abs(p.x()), 12.0);
  for (const Vec3& p : (*pieces)[2].vertices) EXPECT_GT(p.x(), 3.0);
}

TEST(CutArch, pieces_find_their_occlusion) {
  const auto upper = test::make_arch({.seed = 3.0}, true);
  const auto lower = test::make_arch({.seed = 3.0, .step_mm = 0.4});
  const std::array<std::array<int, 2>, 2> cuts{{{12, 13}, {22, 23}}};
  const auto pieces = cut_arch(upper, crowns(), cuts);
  ASSERT_TRUE(pieces);
  for (std::size_t n = 0; n < pieces->size(); ++n) {
    const auto& piece = (*pieces)[n];
    const RigidTransform X = geometry::rigid_motion(Vec3(0.4, -0.3, 0.8), Vec3(0.02, -0.015, 0.03),
                                                    geometry::bounding_box(piece).center());
    const auto found = find_occlusion(lower, geometry::transformed(piece, X),
                                      {-Vec3::UnitZ(), -Vec3::UnitY()}, {.is_close = true});
    ASSERT_TRUE(found) << n << ": " << found.error().message;
    double worst_mm = 0.0;
    for (const Vec3& p : piece.vertices)
      worst_mm = std::max(worst_mm, (found->X_L_lower * (X * p) - p).norm());
    EXPECT_LT(worst_mm, 0.3) << n;
  }
}

TEST(CutArch, refuses_teeth_that_are_not_adjacent) {
  const auto arch = test::make_arch({}, true);
  for (const std::array<int, 2>& cut :
       {std::array{12, 14}, {18, 17}, {31, 32}, {11, 11}, {11, 99}}) {
    const auto pieces = cut_arch(arch, crowns(), {&cut, 1});
    ASSERT_FALSE(pieces);
    EXPECT_NE(pieces.error().message.find("are not two adjacent upper teeth"), std::string::npos);
  }
  auto far = crowns();
  for (auto& [fdi, at_L] : far) at_L.x() += fdi < 20 ? -500.0 : 0.0;
  const std::array cut{11, 21};
  EXPECT_FALSE(cut_arch(arch, far, {&cut, 1}));
}

NumberedTeeth four_teeth() {
  NumberedTeeth teeth;
  for (const int fdi : {11, 12, 21, 36}) {
    teeth.teeth.emplace_back();
    teeth.teeth.back().fdi = fdi;
    teeth.numbers.values.push_back(std::uint8_t(fdi));
  }
  teeth.numbers.values.push_back(0);
  teeth.missing = missing_numbers(teeth.teeth);
  return teeth;
}

TEST(RenumberedTeeth, exchange_and_remove) {
  const std::vector<ToothCorrection> corrections{{11, 12}, {12, 11}, {36, 37}, {21, 0}};
  const auto teeth = renumbered(four_teeth(), corrections);
  ASSERT_TRUE(teeth) << teeth.error().message;
  EXPECT_EQ(teeth->numbers.values, (std::vector<std::uint8_t>{12, 11, 0, 37, 0}));
  ASSERT_EQ(teeth->teeth.size(), 3U);
  EXPECT_EQ(teeth->teeth[2].fdi, 37);
  EXPECT_EQ(teeth->missing.size(), 25U);  // Of 28.
}

TEST(RenumberedTeeth, refuse_what_is_not_possible) {
  const auto refused = [](const ToothCorrection& one, const std::string& why) {
    const auto teeth = renumbered(four_teeth(), {&one, 1});
    ASSERT_FALSE(teeth) << why;
    EXPECT_NE(teeth.error().message.find(why), std::string::npos) << teeth.error().message;
  };
  refused({13, 14}, "no tooth was found with the number 13");
  refused({11, 19}, "19 is no FDI number");
  refused({11, 31}, "in the other jaw");
  refused({11, 12}, "two teeth would have the number 12");
}

}  // namespace
}  // namespace lefort::dental
