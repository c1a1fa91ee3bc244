#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/tissue_levels.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "anatomy/head_phantom.h"
#include "anatomy/mesh_checks.h"

namespace lefort::anatomy::test_tissue_levels {
namespace {

using image::ScalarVolume;
using test::HeadPhantom;

const HeadPhantom kHead;

/// The phantom and all its level-set functions, computed once.
struct Levels {
  image::CtVolume ct = kHead.scan();
  LabelMap labels = segment_tissue(ct).value();
  ScalarVolume bone = bone_level(ct, labels, Cavities::kKeep);
  ScalarVolume solid = bone_level(ct, labels, Cavities::kFillSinuses);
  ScalarVolume skin = skin_level(ct, labels);
  ScalarVolume soft = soft_tissue_level(ct, labels);
};

const Levels& levels() {
  static const Levels all;
  return all;
}

double sample(const ScalarVolume& level, const Vec3& p_L) {
  const Vec3 index = level.grid.index_V(p_L);
  const Vec3 low = index.array().floor();
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::array<Index, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool high = ((corner >> axis) & 1) != 0;
      const double t = index[Index(axis)] - low[Index(axis)];
      weight *= high ? t : 1.0 - t;
      at[axis] = Index(low[Index(axis)]) + (high ? 1 : 0);
    }
    sum += weight * double(level.at(at[0], at[1], at[2]));
  }
  return sum;
}

/// The first zero crossing to negative values along from + s * direction after s = begin.
double end_along(const ScalarVolume& level, const Vec3& from, const Vec3& direction, double begin,
                 double limit) {
  for (double s = begin; s < limit; s += 0.02)
    if (sample(level, from + s * direction) < 0.0) return s;
  return limit;
}

/// Directions over the vertex and the back of the head, away from face and hole.
std::vector<Vec3> free_directions() {
  std::vector<Vec3> directions;
  for (int n = 0; n < 60; ++n) {
    const double z = 0.05 + 0.9 * n / 60.0;
    const double angle = 2.4 * n;
    const Vec3 d(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    if (d.dot(kHead.defect_axis) < 0.9) directions.push_back(d);
  }
  return directions;
}

TEST(TissueLevels, AllArePaddedByTwoVoxelsAndNegativeAllAround) {
  for (const ScalarVolume* level :
       {&levels().bone, &levels().solid, &levels().skin, &levels().soft}) {
    const auto& size = level->grid.size;
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(size[axis], levels().ct.grid.size[axis] + 4);
    EXPECT_LT((level->grid.point_L({2, 2, 2}) - levels().ct.grid.origin_L).norm(), 1e-9);
    for (Index k = 0; k < size[2]; ++k)
      for (Index j = 0; j < size[1]; ++j)
        for (Index i = 0; i < size[0]; ++i)
          if (i < 2 || j < 2 || k < 2 || i >= size[0] - 2 || j >= size[1] - 2 || k >= size[2] - 2) {
            ASSERT_LT(level->at(i, j, k), 0.0F);
          }
  }
}

TEST(TissueLevels, BoneAndSkinLieWhereTheirThresholdsAre) {
  // From the gradients of HeadPhantom::hu, whose middles are the surfaces of the balls.
  const double bone_mm =
      HeadPhantom::kOuterTable + HeadPhantom::kBlur_mm * (1.0 - 2.0 * (226.0 - 40.0) / 860.0);
  const double skin_mm =
      HeadPhantom::kSkinRadius + HeadPhantom::kBlur_mm * (1.0 - 2.0 * 700.0 / 1040.0);
  double worst_bone = 0.0;
  double worst_skin = 0.0;
  for (const Vec3& d : free_directions()) {
    worst_bone = std::max(worst_bone,
                          std::abs(end_along(levels().bone, {0, 0, 0}, d, 71.5, 80.0) - bone_mm));
    worst_skin = std::max(worst_skin,
                          std::abs(end_along(levels().skin, {0, 0, 0}, d, 30.0, 90.0) - skin_mm));
  }
  const double quarter_voxel_mm = 0.25 * levels().ct.grid.spacing_mm.maxCoeff();
  RecordProperty("bone_mm", std::to_string(worst_bone));
  RecordProperty("skin_mm", std::to_string(worst_skin));
  EXPECT_LT(worst_bone, quarter_voxel_mm);
  EXPECT_LT(worst_skin, quarter_voxel_mm);
}

TEST(TissueLevels, SoftTissueEndsExactlyWhereBoneAndOutsideBegin) {
  for (const Vec3& d : free_directions()) {
    const double bone_ends = end_along(levels().solid, {0, 0, 0}, d, 71.5, 80.0);
    const double skin_ends = end_along(levels().skin, {0, 0, 0}, d, 30.0, 90.0);
    EXPECT_LT(sample(levels().soft, (bone_ends - 0.1) * d), 0.0);
    EXPECT_GT(sample(levels().soft, (bone_ends + 0.1) * d), 0.0);
    EXPECT_NEAR(end_along(levels().soft, {0, 0, 0}, d, bone_ends + 0.2, 90.0), skin_ends, 0.05);
  }
}

TEST(TissueLevels, NoSoftTissueIsLeftInTheCranialCavity) {
  for (const Vec3& d : free_directions())
    for (double r = 0.0; r < HeadPhantom::kOuterTable - 1.0; r += 0.5)
      ASSERT_LT(sample(levels().soft, r * d), 0.0) << r;
  // In the hole it begins somewhere between the tables.
  EXPECT_LT(sample(levels().soft, 64.0 * kHead.defect_axis), 0.0);
  EXPECT_GT(sample(levels().soft, 78.0 * kHead.defect_axis), 0.0);
}

TEST(TissueLevels, SinusesAreCavitiesOfBoneAndFilledInTheSolid) {
  EXPECT_LT(sample(levels().bone, kHead.sinus), 0.0);
  for (double r = -9.0; r <= 9.0; r += 1.0)
    for (Index axis = 0; axis < 3; ++axis)
      EXPECT_GT(sample(levels().solid, kHead.sinus + r * Vec3::Unit(axis)), 0.0);
  EXPECT_LT(sample(levels().solid, kHead.pharynx), 0.0) << "the airway is not filled";
  EXPECT_LT(sample(levels().soft, kHead.sinus), 0.0);
  EXPECT_LT(sample(levels().soft, kHead.pharynx), 0.0);
}

TEST(TissueLevels, FillingTheSinusDoesNotMoveTheOuterSurfaceOfBone) {
  const Vec3 forward(0.3, -0.9, 0.3);
  const double kept = end_along(levels().bone, kHead.sinus, forward.normalized(), 12.5, 25.0);
  const double filled = end_along(levels().solid, kHead.sinus, forward.normalized(), 0.0, 25.0);
  EXPECT_NEAR(kept, filled, 0.02);
}

TEST(TissueLevels, NeitherHolderNorIslandIsBone) {
  EXPECT_LT(sample(levels().bone, {0.0, 100.0, 0.0}), 0.0);
  EXPECT_LT(sample(levels().skin, {0.0, 100.0, 0.0}), 0.0);
  EXPECT_LT(sample(levels().bone, kHead.island), 0.0);
}

TEST(TissueLevels, TheNostrilIsOpenInFrontAndClosedWithin) {
  // Along the nostril the ball of the face ends at y of about -101 mm.
  EXPECT_LT(sample(levels().skin, {-12.0, -99.0, -72.0}), 0.0);
  EXPECT_GT(sample(levels().skin, {-12.0, -80.0, -72.0}), 0.0);
  EXPECT_GT(sample(levels().skin, kHead.pharynx), 0.0);
}

TEST(TissueLevels, SurfacesAreClosedAndTheSkinIsOneComponent) {
  for (const ScalarVolume* level :
       {&levels().bone, &levels().solid, &levels().skin, &levels().soft}) {
    const auto mesh = extract_isosurface(*level, {.min_part_ml = 0.01});
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(test::count_bad_edges(*mesh), 0);
    EXPECT_GT(test::volume(*mesh), 0.0);
  }
  const auto skin = extract_isosurface(levels().skin, {.min_part_ml = 0.01});
  EXPECT_EQ(test::euler_number(*skin), 2);
}

/// A ball of bone in a ball of soft tissue, with the noise of a thin slice, on voxels of any shape.
struct NoisyBall {
  static constexpr double kBone_mm = 12.0;
  static constexpr double kSkin_mm = 20.0;
  image::CtVolume ct;
  LabelMap labels;

  explicit NoisyBall(const Vec3& spacing_mm) {
    constexpr double kHalf_mm = 24.0;
    ct.grid.spacing_mm = spacing_mm;
    ct.grid.origin_L = Vec3(-kHalf_mm, -kHalf_mm, -kHalf_mm);
    for (std::size_t axis = 0; axis < 3; ++axis)
      ct.grid.size[axis] = Index(std::lround(2.0 * kHalf_mm / spacing_mm[Index(axis)])) + 1;
    labels.grid = ct.grid;
    std::mt19937 random(7);
    const auto ramp = [](double d) { return std::clamp(0.5 + 0.5 * d / 1.5, 0.0, 1.0); };
    for (Index k = 0; k < ct.grid.size[2]; ++k)
      for (Index j = 0; j < ct.grid.size[1]; ++j)
        for (Index i = 0; i < ct.grid.size[0]; ++i) {
          const double r_mm = ct.grid.point_L({double(i), double(j), double(k)}).norm();
          const double noise_hu = double(random() % 401) - 200.0;
          ct.values.push_back(std::int16_t(std::lround(-1000.0 + 1040.0 * ramp(kSkin_mm - r_mm) +
                                                       860.0 * ramp(kBone_mm - r_mm) + noise_hu)));
          labels.values.push_back(r_mm < kBone_mm   ? Tissue::kBone
                                  : r_mm < kSkin_mm ? Tissue::kSoftTissue
                                                    : Tissue::kBackground);
        }
  }
};

/// Distance between the zero crossing and a ball [mm], root mean square, in directions near the
/// plane of the slices.
double straying_mm(const ScalarVolume& level, double begin_mm, double limit_mm) {
  double sum = 0.0, squares = 0.0;
  constexpr int kDirections = 200;
  for (int n = 0; n < kDirections; ++n) {
    const double z = 0.4 * (n / double(kDirections) - 0.5);
    const double angle = 2.4 * n;
    const Vec3 d(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    const double end_mm = end_along(level, {0, 0, 0}, d, begin_mm, limit_mm);
    sum += end_mm / kDirections;
    squares += end_mm * end_mm / kDirections;
  }
  return std::sqrt(std::max(0.0, squares - sum * sum));
}

TEST(TissueLevels, NoiseIsSmoothedOverTheSameLengthOnVoxelsOfAnyShape) {
  // Sigmas in voxels only gave 0.05 and 0.06 mm, and 0.03 and 0.04 mm.
  for (const auto& [spacing_mm, limit_mm] :
       {std::pair(Vec3(0.4, 0.4, 3.0), 0.045), std::pair(Vec3(0.3, 0.3, 0.3), 0.025)}) {
    const NoisyBall ball(spacing_mm);
    const ScalarVolume bone = bone_level(ball.ct, ball.labels, Cavities::kKeep);
    const ScalarVolume skin = skin_level(ball.ct, ball.labels);
    const double bone_mm = straying_mm(bone, 8.0, 16.0), skin_mm = straying_mm(skin, 15.0, 23.0);
    EXPECT_LT(bone_mm, limit_mm) << spacing_mm.transpose();
    EXPECT_LT(skin_mm, limit_mm) << spacing_mm.transpose();
  }
}

TEST(TissueLevels, SoftTissueEndsAtBoneAndSkinOnVoxelsOfAnyShape) {
  for (const Vec3& spacing_mm : {Vec3(0.4, 0.4, 3.0), Vec3(0.5, 0.5, 0.5)}) {
    const NoisyBall ball(spacing_mm);
    const ScalarVolume solid = bone_level(ball.ct, ball.labels, Cavities::kFillSinuses);
    const ScalarVolume skin = skin_level(ball.ct, ball.labels);
    const ScalarVolume soft = soft_tissue_level(ball.ct, ball.labels);
    for (int n = 0; n < 60; ++n) {
      const double z = 0.95 * (n / 30.0 - 1.0);
      const Vec3 d(std::sqrt(1 - z * z) * std::cos(2.4 * n),
                   std::sqrt(1 - z * z) * std::sin(2.4 * n), z);
      const double bone_mm = end_along(solid, {0, 0, 0}, d, 6.0, 16.0);
      const double skin_mm = end_along(skin, {0, 0, 0}, d, 15.0, 23.5);
      EXPECT_GT(sample(soft, (bone_mm + 0.2) * d), 0.0) << n;
      EXPECT_LT(sample(soft, (bone_mm - 0.2) * d), 0.0) << n;
      EXPECT_NEAR(end_along(soft, {0, 0, 0}, d, bone_mm + 0.3, 23.5), skin_mm, 0.05) << n;
    }
  }
}

TEST(TissueLevels, DoNotDependOnWhichSoftTissueIsMuscle) {
  LabelMap labels = levels().labels;
  std::size_t painted = 0;
  for (std::size_t v = 0; v < labels.values.size(); ++v)
    if (labels.values[v] == Tissue::kSoftTissue && ++painted % 3 != 0)
      labels.values[v] = Tissue::kMuscle;
  EXPECT_GT(painted, 1000U);
  const image::CtVolume& ct = levels().ct;
  EXPECT_EQ(bone_level(ct, labels, Cavities::kKeep).values, levels().bone.values);
  EXPECT_EQ(bone_level(ct, labels, Cavities::kFillSinuses).values, levels().solid.values);
  EXPECT_EQ(skin_level(ct, labels).values, levels().skin.values);
  EXPECT_EQ(soft_tissue_level(ct, labels).values, levels().soft.values);
}

TEST(TissueLevels, DisconnectedSoftTissueIsReportedAndLeftOut) {
  class Notes : public Progress {
   public:
    void note(std::string_view sentence) override { sentences.emplace_back(sentence); }
    std::vector<std::string> sentences;
  };
  Notes whole, loose;
  static_cast<void>(soft_tissue_level(levels().ct, levels().labels, {}, whole));
  EXPECT_TRUE(whole.sentences.empty());
  // 10 x 10 x 10 voxels with a total of 7.1 ml, in a corner of the scan far from the head.
  image::CtVolume ct = levels().ct;
  LabelMap labels = levels().labels;
  for (Index k = 70; k < 80; ++k)
    for (Index j = 2; j < 12; ++j)
      for (Index i = 2; i < 12; ++i) {
        ct.at(i, j, k) = 40;
        labels.at(i, j, k) = Tissue::kSoftTissue;
      }
  const ScalarVolume level = soft_tissue_level(ct, labels, {}, loose);
  EXPECT_LT(level.at(9, 9, 77), 0.0F);
  ASSERT_EQ(loose.sentences.size(), 1U);
  EXPECT_NE(loose.sentences[0].find(" ml of soft tissue are not connected"), std::string::npos);
}

TEST(TissueLevels, VoxelStepsAreRemoved) {
  // On a ball, normals of neighbors differ by edge length / radius, about a degree. Without the
  // Gaussian, voxel steps are visible.
  const auto roughness_deg = [](const ScalarVolume& level) {
    const auto mesh = extract_isosurface(level).value();
    double sum = 0.0;
    double count = 0.0;
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
      const Vec3 p = mesh.corner(t, 0);
      const Vec3 area = test::area_vector(mesh, t);
      if (p.norm() < 80.0 || p.z() < 10.0 || area.norm() < 1e-3) continue;
      sum += std::pow(std::acos(std::min(1.0, area.normalized().dot(p.normalized()))), 2);
      count += 1.0;
    }
    return std::sqrt(sum / count) * 180.0 / M_PI;
  };
  const Levels& l = levels();
  EXPECT_LT(roughness_deg(l.skin), 2.0);
  EXPECT_GT(roughness_deg(skin_level(l.ct, l.labels, {.skin_smoothing_mm = 0.0})), 5.0);
  // A scan without partial volume has only steps.
  image::CtVolume steps = l.ct;
  for (std::int16_t& hu : steps.values) hu = hu < -300 ? -1000 : 40;
  EXPECT_GT(roughness_deg(skin_level(steps, l.labels, {.skin_smoothing_mm = 0.0})), 6.0);
}

}  // namespace
}  // namespace lefort::anatomy::test_tissue_levels
