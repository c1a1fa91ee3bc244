/// \file
/// The mandible and the teeth of a skull with known jaws, and the border of its bone.
#include <lefort/anatomy/find_mandible.h>
#include <lefort/anatomy/find_occlusal_planes.h>
#include <lefort/anatomy/find_teeth.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/sharpen_bone.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "anatomy/jaw_phantom.h"

namespace lefort::anatomy::test_jaws {
namespace {

using test::JawPhantom;

using IsFound = std::function<bool(std::size_t)>;
using IsTrue = std::function<bool(const Vec3&)>;

/// Twice the intersection of what was found with what is true, over the sum of both.
double dice(const JawPhantom& head, const IsFound& found, const IsTrue& is_true) {
  double both = 0.0, sum = 0.0;
  head.for_each_voxel([&](std::size_t v, const Vec3& p) {
    const bool f = found(v), t = is_true(p);
    both += f && t ? 2.0 : 0.0;
    sum += double(f) + double(t);
  });
  return sum > 0.0 ? both / sum : 1.0;
}

/// Each differs from the first in one respect.
const std::map<std::string, JawPhantom>& heads() {
  static const std::map<std::string, JawPhantom> all{
      {"occlusion", {}},
      {"fine", {.voxel_mm = 0.7}},
      {"chin down", {.pitch_deg = 14.0}},
      {"chin up", {.pitch_deg = -14.0}},
      {"open mouth", {.opening_mm = 6.0}},
      {"without enamel", {.opening_mm = 4.0, .enamel_hu = 1000.0}}};
  return all;
}

const LabelMap& labels_of(const std::string& name) {
  static std::map<std::string, LabelMap> cache;
  if (!cache.contains(name)) cache[name] = segment_tissue(heads().at(name).scan()).value();
  return cache[name];
}

TEST(Mandible, IsDividedFromTheSkullAtTheOcclusionAndBothJoints) {
  for (const auto& [name, head] : heads()) {
    SCOPED_TRACE(name);
    const LabelMap& labels = labels_of(name);
    const auto is = [&](Tissue tissue) {
      return [&labels, tissue](std::size_t v) { return labels.values[v] == tissue; };
    };
    EXPECT_GT(dice(head, is(Tissue::kMandible),
                   [&, &h = head](const Vec3& p) {
                     return h.mandible(p) > 0.0 && JawPhantom::skull(p) <= 0.0;
                   }),
              0.95);
    EXPECT_GT(dice(head, is(Tissue::kBone),
                   [&, &h = head](const Vec3& p) {
                     return h.mandible(p) <= 0.0 && JawPhantom::skull(p) > 0.0;
                   }),
              0.95);
    const Components parts =
        connected_components(mask_where(labels.grid, is(Tissue::kMandible)), Neighbors::kFaces);
    EXPECT_EQ(parts.count(), 1);
  }
}

TEST(Mandible, ContainsBothCondylesAndNoUpperTooth) {
  for (const auto& [name, head] : heads()) {
    SCOPED_TRACE(name);
    const LabelMap& labels = labels_of(name);
    double condyle[2] = {0.0, 0.0}, missed[2] = {0.0, 0.0}, upper = 0.0, wrong = 0.0;
    head.for_each_voxel([&, &h = head](std::size_t v, const Vec3& p) {
      const bool found = labels.values[v] == Tissue::kMandible;
      const Vec3 shut = p + h.opening_mm * Vec3::UnitZ();
      if (h.mandible(p) > 1.0 && shut.z() > 28.0 && shut.y() > 0.0) {
        ++condyle[p.x() > 0.0 ? 1 : 0];
        if (!found) ++missed[p.x() > 0.0 ? 1 : 0];
      }
      if (JawPhantom::teeth(p, 1.0) > 1.0) {
        ++upper;
        if (found) ++wrong;
      }
    });
    for (const int side : {0, 1}) {
      ASSERT_GT(condyle[side], 0.0);
      EXPECT_LT(missed[side], 0.05 * condyle[side]);
    }
    ASSERT_GT(upper, 0.0);
    EXPECT_LT(wrong, 0.02 * upper);
  }
}

TEST(Mandible, IsAbsentWhereThereIsNone) {
  const JawPhantom head{.has_mandible = false};
  const LabelMap labels = segment_tissue(head.scan()).value();
  EXPECT_EQ(std::count(labels.values.begin(), labels.values.end(), Tissue::kMandible), 0);
}

TEST(OcclusalPlane, LiesBetweenTheCrownsAndIsTiltedAsTheHead) {
  for (const auto& [name, head] : heads()) {
    SCOPED_TRACE(name);
    const image::CtVolume ct = head.scan();
    const Mask bone = mask_where(ct.grid, [&](std::size_t v) { return ct.values[v] >= 226; });
    const auto planes = find_occlusal_planes(ct, bone, 226.0);
    ASSERT_FALSE(planes.empty());
    const double angle = -head.pitch_deg * std::numbers::pi / 180.0;
    const Vec3 normal_L = Eigen::AngleAxisd(-angle, Vec3::UnitX()) * Vec3::UnitZ();
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    EXPECT_LT(std::acos(std::min(1.0, normal_L.dot(planes[0].normal_L))) * kDegrees, 6.0);
    const Vec3 middle_L =
        Eigen::AngleAxisd(-angle, Vec3::UnitX()) * Vec3(0.0, -40.0, -0.5 * head.opening_mm);
    EXPECT_NEAR(planes[0].height_mm(middle_L), 0.0, 2.5);
  }
}

TEST(Teeth, AreFoundInBothJawsWithTheirRoots) {
  for (const auto& [name, head] : heads()) {
    SCOPED_TRACE(name);
    const ToothMap teeth = find_teeth(head.scan(), labels_of(name), 226.0);
    for (const Tooth tooth : {Tooth::kUpper, Tooth::kLower}) {
      const auto found = [&](std::size_t v) { return teeth.values[v] == tooth; };
      const auto is_true = [&, &h = head](const Vec3& p) {
        return h.teeth_of(p, tooth == Tooth::kLower) > 0.0;
      };
      if (name == "without enamel")
        EXPECT_EQ(std::count(teeth.values.begin(), teeth.values.end(), tooth), 0);
      else
        EXPECT_GT(dice(head, found, is_true), 0.88);
    }
  }
}

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
    if (x_mm < 24.0)
      EXPECT_EQ(labels.at(i, 1, 1) == Tissue::kBone, thick) << x_mm;
    else if (x_mm > 28.25 && x_mm < 29.25)
      EXPECT_EQ(labels.at(i, 1, 1), Tissue::kBone) << x_mm;
  }
  EXPECT_NE(before.values, labels.values);
}

}  // namespace
}  // namespace lefort::anatomy::test_jaws
