/// \file
/// Skull and mandible are separate closed surfaces, however narrow the gap between them.
#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/head_from_surfaces.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/anatomy/tissue_volumes.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "anatomy/mesh_checks.h"
#include "support/shapes.h"

namespace lefort::anatomy::test_separate_levels {
namespace {

/// Distance to a bone [mm], positive inside.
using Depth = std::function<double(const Vec3&)>;

struct TwoBones {
  Depth skull, mandible;
};

double capsule(const Vec3& p, const Vec3& a, const Vec3& b, double radius_mm) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return radius_mm - (p - a - t * (b - a)).norm();
}

/// A condyle below a round eminence; the joint space is `gap_mm`.
TwoBones joint(double gap_mm) {
  return {[=](const Vec3& p) { return 8.0 - (p - Vec3(0.3, 0.4, 8.0 + 0.5 * gap_mm)).norm(); },
          [=](const Vec3& p) { return 6.0 - (p - Vec3(0.3, 0.4, -6.0 - 0.5 * gap_mm)).norm(); }};
}

/// Three pairs of teeth with flat contact at z = 0.3, each row on a bar.
TwoBones occlusion() {
  const auto row = [](const Vec3& p, double side) {
    const double z = side * (p.z() - 0.3);
    double depth = capsule(p, {-9, 0, 0.3 + side * 13}, {9, 0, 0.3 + side * 13}, 3.5);
    for (const double x : {-9.0, 0.0, 9.0}) {
      const double tooth = std::min(z, capsule({p.x(), p.y(), z}, {x, 0, -9}, {x, 0, 12}, 3.5));
      // With a fillet: a Gaussian rounds sharp inner edges by more than half a voxel.
      const double h = std::max(4.0 - std::abs(depth - tooth), 0.0) / 4.0;
      depth = std::max(depth, tooth) + h * h;
    }
    return depth;
  };
  return {[=](const Vec3& p) { return row(p, 1.0); }, [=](const Vec3& p) { return row(p, -1.0); }};
}

/// Mean CT numbers of voxels, and labels as a watershed assigns them: a voxel at or above the
/// threshold belongs to the closer bone.
LabeledScan scan_of(const TwoBones& bones, const Vec3& spacing_mm) {
  constexpr double kHalf_mm = 20.0, kBone_hu = 412.0, kSoft_hu = 40.0;  // Their mean is 226 HU.
  constexpr int kSamples = 4;
  image::Grid grid;
  grid.spacing_mm = spacing_mm;
  grid.origin_L = Vec3::Constant(-kHalf_mm);
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.size[axis] = Index(std::lround(2.0 * kHalf_mm / spacing_mm[Index(axis)])) + 1;
  const auto count = std::size_t(grid.voxel_count());
  LabeledScan scan{{grid, std::vector<std::int16_t>(count)}, {grid, std::vector<Tissue>(count)}};
  parallel_for(grid.voxel_count(), [&](Index v) {
    const Vec3 at(double(v % grid.size[0]), double(v / grid.size[0] % grid.size[1]),
                  double(v / (grid.size[0] * grid.size[1])));
    const auto depth_mm = [&](const Vec3& p_L) {
      return std::max(bones.skull(p_L), bones.mandible(p_L));
    };
    const Vec3 center_L = grid.point_L(at);
    const bool is_pure = std::abs(depth_mm(center_L)) > spacing_mm.norm();
    int inside = is_pure && depth_mm(center_L) > 0.0 ? kSamples * kSamples * kSamples : 0;
    for (int n = 0; !is_pure && n < kSamples * kSamples * kSamples; ++n) {
      const Vec3 cell(n % kSamples, n / kSamples % kSamples, n / (kSamples * kSamples));
      const Vec3 p_L = grid.point_L(at + Vec3((cell.array() + 0.5) / double(kSamples) - 0.5));
      inside += depth_mm(p_L) > 0.0 ? 1 : 0;
    }
    const double part = double(inside) / (kSamples * kSamples * kSamples);
    scan.ct.values[std::size_t(v)] =
        std::int16_t(std::lround(kSoft_hu + (kBone_hu - kSoft_hu) * part));
    scan.labels.values[std::size_t(v)] = part < 0.5 ? Tissue::kSoftTissue
                                         : bones.skull(center_L) > bones.mandible(center_L)
                                             ? Tissue::kBone
                                             : Tissue::kMandible;
  });
  return scan;
}

/// Checks that the surfaces are two closed components, and that each lies within half a voxel of
/// its bone where the other bone is `away_mm` away.
void expect_two_bones(const LabeledScan& scan, const TwoBones& bones, double away_mm) {
  const double voxel_mm = scan.ct.grid.spacing_mm.maxCoeff();
  for (const Cavities cavities : {Cavities::kKeep, Cavities::kFillSinuses}) {
    const auto mesh = extract_isosurface(bone_level(scan.ct, scan.labels, cavities));
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(geometry::connected_components(*mesh).count, 2);
    EXPECT_EQ(test::count_bad_edges(*mesh), 0);
  }
  for (const bool is_skull : {true, false}) {
    const auto mesh = extract_isosurface(bone_level(scan.ct, scan.labels, Cavities::kKeep, {},
                                                    is_skull ? Bones::kSkull : Bones::kMandible));
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(geometry::connected_components(*mesh).count, 1) << is_skull;
    const Depth& own = is_skull ? bones.skull : bones.mandible;
    const Depth& other = is_skull ? bones.mandible : bones.skull;
    double max_mm = 0.0, deepest_mm = -1e9;
    for (const Vec3& p_L : mesh->vertices) {
      deepest_mm = std::max(deepest_mm, other(p_L));
      if (other(p_L) < -away_mm) max_mm = std::max(max_mm, std::abs(own(p_L)));
    }
    EXPECT_LT(max_mm, 0.5 * voxel_mm) << (is_skull ? "skull" : "mandible");
    EXPECT_LT(deepest_mm, 0.5 * voxel_mm) << "enters the other bone";
  }
}

TEST(SeparateLevels, ANarrowJointIsTwoClosedSurfaces) {
  for (const Vec3& spacing_mm : {Vec3(0.5, 0.5, 0.5), Vec3(1, 1, 1), Vec3(0.9, 0.9, 1.8)})
    for (const double gap_mm : {0.0, 0.5, 1.0, 2.0}) {
      SCOPED_TRACE(testing::Message() << spacing_mm.transpose() << ", gap " << gap_mm);
      const TwoBones bones = joint(gap_mm);
      expect_two_bones(scan_of(bones, spacing_mm), bones, 2.5 * spacing_mm.maxCoeff());
    }
}

TEST(SeparateLevels, TeethInContactBelongToTheirJaws) {
  for (const Vec3& spacing_mm : {Vec3(0.5, 0.5, 0.5), Vec3(0.4, 0.4, 1.0)}) {
    SCOPED_TRACE(testing::Message() << spacing_mm.transpose());
    const TwoBones bones = occlusion();
    expect_two_bones(scan_of(bones, spacing_mm), bones, 2.5);
  }
}

TEST(SeparateLevels, AllBonesAreTheMaximumOfSkullAndMandible) {
  const LabeledScan scan = scan_of(joint(0.5), {1, 1, 1});
  const auto of = [&](Bones bones) {
    return bone_level(scan.ct, scan.labels, Cavities::kKeep, {}, bones).values;
  };
  const auto all = of(Bones::kAll), skull = of(Bones::kSkull), mandible = of(Bones::kMandible);
  std::size_t in_mandible = 0;
  for (std::size_t v = 0; v < all.size(); ++v) {
    ASSERT_EQ(all[v], std::max(skull[v], mandible[v]));
    ASSERT_FALSE(skull[v] >= 0.0F && mandible[v] >= 0.0F);
    in_mandible += mandible[v] >= 0.0F ? 1 : 0;
  }
  EXPECT_NEAR(double(in_mandible), 4.0 / 3.0 * M_PI * 216.0, 60.0);
}

TEST(SeparateLevels, AJointSpaceIsNotFilledAsASinusIs) {
  // A condyle in a cup with a joint space of 6.5 mm, whose rim touches the neck of the condyle.
  const TwoBones bones{[](const Vec3& p) {
                         const double r = p.norm();
                         return std::min({16.0 - r, r - 12.0, p.z() + 10.0});
                       },
                       [](const Vec3& p) {
                         return std::max(5.5 - p.norm(), capsule(p, {0, 0, -10}, {0, 0, -24}, 7.5));
                       }};
  LabeledScan scan = scan_of(bones, {1, 1, 1});
  const image::ScalarVolume level =
      bone_level(scan.ct, scan.labels, Cavities::kFillSinuses, {}, Bones::kAll);
  const Vec3 space_V = level.grid.index_V({0.0, 0.0, 9.0});
  EXPECT_LT(level.at(Index(space_V[0]), Index(space_V[1]), Index(space_V[2])), 0.0F);
  // The same space, if both are skull, is enclosed and filled.
  std::replace(scan.labels.values.begin(), scan.labels.values.end(), Tissue::kMandible,
               Tissue::kBone);
  const image::ScalarVolume filled =
      bone_level(scan.ct, scan.labels, Cavities::kFillSinuses, {}, Bones::kAll);
  EXPECT_GT(filled.at(Index(space_V[0]), Index(space_V[1]), Index(space_V[2])), 0.0F);
}

TEST(SeparateLevels, LabeledBoneWithinASurfaceIsMeasured) {
  const LabeledScan scan = scan_of(joint(1.0), {1, 1, 1});
  // Half of both balls, and nothing else.
  const BoneVolumes half =
      bone_volumes_within(scan.labels, test::make_box({0.3, -18, -18}, {18, 18, 18}));
  EXPECT_NEAR(half.skull_ml, 2.0 / 3.0 * M_PI * 0.512, 0.06);
  EXPECT_NEAR(half.mandible_ml, 2.0 / 3.0 * M_PI * 0.216, 0.03);
  EXPECT_EQ(bone_volumes_within(scan.labels, {}).skull_ml, 0.0);
}

TEST(SeparateLevels, SurfacesThatNearlyTouchStayApart) {
  for (const double gap_mm : {0.0, 0.5, 1.0, 2.0}) {
    SCOPED_TRACE(gap_mm);
    const HeadSurfaces head{test::make_icosphere(45.0, 4),
                            test::make_icosphere(16.0, 4, {0, 0, 16.0 + 0.5 * gap_mm}),
                            test::make_icosphere(14.0, 4, {0, 0, -14.0 - 0.5 * gap_mm})};
    const auto scan = scan_from_surfaces(head, 1.0);
    ASSERT_TRUE(scan) << scan.error().message;
    const auto bones =
        extract_isosurface(bone_level(scan->ct, scan->labels, Cavities::kFillSinuses));
    ASSERT_TRUE(bones) << bones.error().message;
    EXPECT_EQ(geometry::connected_components(*bones).count, 2);
    EXPECT_EQ(test::count_bad_edges(*bones), 0);
    const geometry::Bvh skull(head.skull_L), mandible(*head.mandible_L);
    double max_mm = 0.0;
    for (const Vec3& p_L : bones->vertices)
      if (std::abs(p_L.z()) > 2.5)
        max_mm = std::max(max_mm, std::min(skull.closest_point(p_L)->distance_mm,
                                           mandible.closest_point(p_L)->distance_mm));
    EXPECT_LT(max_mm, 0.5);
  }
}

}  // namespace
}  // namespace lefort::anatomy::test_separate_levels
