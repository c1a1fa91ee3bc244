/// \file
/// The border of bone lies at half its maximum.
#include <lefort/anatomy/sharpen_bone.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::anatomy::test_sharpen_bone {
namespace {

TEST(SharpenBone, KeepsThinBoneAndRemovesTheBlurOfThickBone) {
  // Two plates across x, blurred over 1.5 mm: 8 mm thick with 1000 HU, and 1 mm thick.
  image::CtVolume ct{{{80, 4, 4}, Vec3::Constant(0.5), Vec3::Zero(), Mat3::Identity()}, {}};
  LabelMap labels{ct.grid, {}};
  const auto inside = [](double x, double first, double last) {
    return 0.5 * (std::erf((x - first) / 0.9) - std::erf((x - last) / 0.9));
  };
  for (std::size_t v = 0; v < 80 * 4 * 4; ++v) {
    const double x_mm = 0.5 * double(v % 80);
    const double fraction = inside(x_mm, 10.25, 18.25) + inside(x_mm, 28.25, 29.25);
    ct.values.push_back(std::int16_t(40.0 + 960.0 * fraction));
    labels.values.push_back(ct.values.back() >= 226 ? Tissue::kBone : Tissue::kSoftTissue);
  }
  const LabelMap before = labels;
  sharpen_bone(ct, labels);
  for (Index i = 0; i < 80; ++i) {
    const double x_mm = 0.5 * double(i);
    const bool thick = x_mm > 10.25 && x_mm < 18.25;
    const bool thin = x_mm > 28.25 && x_mm < 29.25;
    if (x_mm < 24.0 || thin) {
      EXPECT_EQ(labels.at(i, 1, 1) == Tissue::kBone, thick || thin) << x_mm;
    }
  }
  EXPECT_NE(before.values, labels.values);
}

}  // namespace
}  // namespace lefort::anatomy::test_sharpen_bone
