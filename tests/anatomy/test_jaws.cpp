/// \file
/// The occlusal plane, the mandible and the teeth of a skull with known jaws.
#include <lefort/anatomy/find_mandible.h>
#include <lefort/anatomy/find_occlusal_planes.h>
#include <lefort/anatomy/find_teeth.h>
#include <lefort/anatomy/segment_tissue.h>

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
      {"open mouth", JawScan({.pitch_deg = -8.0, .opening_deg = 3.5})},
      {"without enamel", JawScan({.opening_deg = 4.0, .enamel_hu = 1000.0})}};
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
    // Otherwise the mandible would be a component of its own, and there would be nothing to divide.
    const Mask bone =
        mask_where(scan.ct.grid, [&, &ct = scan.ct](std::size_t v) { return ct.values[v] >= 226; });
    ASSERT_EQ(connected_components(bone, Neighbors::kFaces).count(), 1);
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
    EXPECT_GT(dice(scan, is(Tissue::kMandible), in_mandible), 0.95);
    EXPECT_GT(dice(scan, is(Tissue::kBone), in_skull), 0.99);
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
      const Vec3 p = scan.head.closed(scan.point[v]);
      if (scan.depth[v][kMandible] > 1.0F && p.z() > 28.0) {
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
    // Enamel is fitted; the gap without it is sought in steps of 4 degrees.
    const bool has_enamel = name != "without enamel";
    EXPECT_EQ(planes[0].is_of_enamel, has_enamel);
    const Mat3 tilt = JawPhantom::turned(scan.head.pitch_deg + 0.5 * scan.head.opening_deg);
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    const double cosine = (tilt * Vec3::UnitZ()).dot(planes[0].normal_L);
    EXPECT_LT(std::acos(std::min(1.0, cosine)) * kDegrees, has_enamel ? 1.5 : 4.0);
    const Vec3 upper(0.0, -40.0, 0.0), joint = JawPhantom::condyle(0.0);
    const Vec3 lower = joint + JawPhantom::turned(scan.head.opening_deg) * (upper - joint);
    const Vec3 middle_L = JawPhantom::turned(scan.head.pitch_deg) * (0.5 * (upper + lower));
    EXPECT_NEAR(planes[0].height_mm(middle_L), 0.0, 1.0);
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
      if (name == "without enamel") {
        EXPECT_EQ(std::count(teeth.values.begin(), teeth.values.end(), tooth), 0);
        continue;
      }
      EXPECT_GT(dice(scan, is_found, is_true), 0.9);
      double roots = 0.0, missed = 0.0;
      for (std::size_t v = 0; v < scan.depth.size(); ++v) {
        const Vec3& p = scan.point[v];
        const double z = tooth == Tooth::kUpper ? p.z() : -scan.head.closed(p).z();
        if (!is_true(v) || z < 10.0) continue;
        ++roots;
        if (!is_found(v)) ++missed;
      }
      ASSERT_GT(roots, 0.0);
      EXPECT_LT(missed, 0.05 * roots);
    }
  }
}

}  // namespace
}  // namespace lefort::anatomy::test_jaws
