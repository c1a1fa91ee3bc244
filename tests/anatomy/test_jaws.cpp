/// \file
/// The mandible and the teeth of a skull with known jaws, and the border of its bone.
#include <lefort/anatomy/find_mandible.h>
#include <lefort/anatomy/find_occlusal_planes.h>
#include <lefort/anatomy/find_teeth.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/sharpen_bone.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>

#include "anatomy/jaw_phantom.h"

namespace lefort::anatomy::test_jaws {
namespace {

using test::JawPhantom;
using test::JawScan;

enum Depth : std::size_t { kSkull, kMandible, kUpperTeeth, kLowerTeeth };

using Belongs = std::function<bool(std::size_t)>;

/// Twice the intersection of what was found with what is true, over the sum of both.
double dice(const JawScan& scan, const Belongs& is_found, const Belongs& is_true) {
  double both = 0.0, sum = 0.0;
  for (std::size_t v = 0; v < scan.depth.size(); ++v) {
    const bool f = is_found(v), t = is_true(v);
    both += f && t ? 2.0 : 0.0;
    sum += double(f) + double(t);
  }
  return sum > 0.0 ? both / sum : 1.0;
}

/// Each differs from the first in one respect or two.
const std::map<std::string, JawScan>& scans() {
  static const std::map<std::string, JawScan> all{
      {"occlusion", JawScan({})},
      {"chin down", JawScan({.pitch_deg = 14.0})},
      {"open mouth", JawScan({.pitch_deg = -8.0, .opening_mm = 6.0})},
      {"without enamel", JawScan({.opening_mm = 4.0, .enamel_hu = 1000.0})}};
  return all;
}

const LabelMap& labels_of(const std::string& name) {
  static std::map<std::string, LabelMap> cache;
  if (!cache.contains(name)) cache[name] = segment_tissue(scans().at(name).ct).value();
  return cache[name];
}

TEST(Mandible, IsDividedFromTheSkullAtTheOcclusionAndBothJoints) {
  for (const auto& [name, scan] : scans()) {
    SCOPED_TRACE(name);
    const LabelMap& labels = labels_of(name);
    const auto is = [&](Tissue tissue) {
      return [&labels, tissue](std::size_t v) { return labels.values[v] == tissue; };
    };
    const auto in_mandible = [&, &depth = scan.depth](std::size_t v) {
      return depth[v][kMandible] > 0.0F && depth[v][kMandible] >= depth[v][kSkull];
    };
    const auto in_skull = [&, &depth = scan.depth](std::size_t v) {
      return depth[v][kSkull] > 0.0F && depth[v][kSkull] > depth[v][kMandible];
    };
    EXPECT_GT(dice(scan, is(Tissue::kMandible), in_mandible), 0.9);
    EXPECT_GT(dice(scan, is(Tissue::kBone), in_skull), 0.9);
    const Components parts =
        connected_components(mask_where(labels.grid, is(Tissue::kMandible)), Neighbors::kFaces);
    EXPECT_EQ(parts.count(), 1);
  }
}

TEST(Mandible, ContainsBothCondylesAndNoUpperTooth) {
  for (const auto& [name, scan] : scans()) {
    SCOPED_TRACE(name);
    const LabelMap& labels = labels_of(name);
    std::array<double, 2> condyle{}, missed{};
    double upper = 0.0, wrong = 0.0;
    for (std::size_t v = 0; v < scan.depth.size(); ++v) {
      const bool is_found = labels.values[v] == Tissue::kMandible;
      const Vec3& p = scan.point[v];
      if (scan.depth[v][kMandible] > 1.0F && p.z() + scan.head.opening_mm > 28.0) {
        const std::size_t side = p.x() > 0.0 ? 1 : 0;
        ++condyle[side];
        if (!is_found) ++missed[side];
      }
      if (scan.depth[v][kUpperTeeth] > 1.0F) {
        ++upper;
        if (is_found) ++wrong;
      }
    }
    for (const std::size_t side : {0, 1}) {
      ASSERT_GT(condyle[side], 0.0);
      EXPECT_LT(missed[side], 0.05 * condyle[side]);
    }
    ASSERT_GT(upper, 0.0);
    EXPECT_LT(wrong, 0.02 * upper);
  }
}

TEST(Mandible, IsAbsentWhereThereIsNone) {
  const JawScan scan({.has_mandible = false});
  const LabelMap labels = segment_tissue(scan.ct).value();
  EXPECT_EQ(std::count(labels.values.begin(), labels.values.end(), Tissue::kMandible), 0);
}

TEST(OcclusalPlane, LiesBetweenTheCrownsAndIsTiltedAsTheHead) {
  for (const auto& [name, scan] : scans()) {
    SCOPED_TRACE(name);
    const Mask bone =
        mask_where(scan.ct.grid, [&, &ct = scan.ct](std::size_t v) { return ct.values[v] >= 226; });
    const auto planes = find_occlusal_planes(scan.ct, bone, 226.0);
    ASSERT_FALSE(planes.empty());
    const double angle = scan.head.pitch_deg * std::numbers::pi / 180.0;
    const Mat3 tilt = Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix();
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    const double cosine = (tilt * Vec3::UnitZ()).dot(planes[0].normal_L);
    EXPECT_LT(std::acos(std::min(1.0, cosine)) * kDegrees, 6.0);
    const Vec3 middle_L = tilt * Vec3(0.0, -40.0, -0.5 * scan.head.opening_mm);
    EXPECT_NEAR(planes[0].height_mm(middle_L), 0.0, 2.5);
  }
}

TEST(Teeth, AreFoundInBothJawsWithTheirRoots) {
  for (const auto& [name, scan] : scans()) {
    SCOPED_TRACE(name);
    const ToothMap teeth = find_teeth(scan.ct, labels_of(name), 226.0);
    for (const Tooth tooth : {Tooth::kUpper, Tooth::kLower}) {
      const std::size_t jaw = tooth == Tooth::kUpper ? kUpperTeeth : kLowerTeeth;
      const auto is_found = [&](std::size_t v) { return teeth.values[v] == tooth; };
      const auto is_true = [&, &depth = scan.depth](std::size_t v) { return depth[v][jaw] > 0.0F; };
      if (name == "without enamel")
        EXPECT_EQ(std::count(teeth.values.begin(), teeth.values.end(), tooth), 0);
      else
        EXPECT_GT(dice(scan, is_found, is_true), 0.85);
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
    const bool thin = x_mm > 28.25 && x_mm < 29.25;
    if (x_mm < 24.0 || thin) {
      EXPECT_EQ(labels.at(i, 1, 1) == Tissue::kBone, thick || thin) << x_mm;
    }
  }
  EXPECT_NE(before.values, labels.values);
}

}  // namespace
}  // namespace lefort::anatomy::test_jaws
