#include <lefort/inverse/fit_preview.h>

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "support/paper_boundary.h"
#include "support/tissue_block.h"

namespace lefort::inverse::test_fit_preview {
namespace {

constexpr double kReached_mm = 0.03;  ///< The fit stops at 0.02 mm; the preview has a tolerance.

RigidTransform shift(const Vec3& by_mm) {
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = by_mm;
  return pose;
}

predict::FacePreview preview_of(const predict::FaceModel& model) {
  return predict::FacePreview::create(model, {"slab"}, test::surface_of(model),
                                      test::paper_options(), Vec3::Ones())
      .value();
}

/// The vertex that a pose moves most, and its displacement.
struct Target {
  Index vertex = 0;
  Vec3 displacement_mm = Vec3::Zero();
};

Target target_at(const predict::FacePreview& preview, const Vec3& by_mm) {
  const auto u_mm = preview.displacement_mm(std::array{shift(by_mm)}).value();
  Target target;
  for (std::size_t v = 0; v < u_mm.size(); ++v)
    if (u_mm[v].norm() > target.displacement_mm.norm()) target = {Index(v), u_mm[v]};
  return target;
}

const std::vector<Vec3> kUp{Vec3::UnitZ()};
const std::vector<Vec3> kAllAxes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};

TEST(FitPreview, FindsThePoseThatMovedAVertexWithContact) {
  const predict::FacePreview preview = preview_of(test::block_on_ball());
  const Target target = target_at(preview, {0.0, 0.0, 1.2});
  const auto fit =
      fit_preview(preview, {shift({0.0, 0.0, 0.5})}, 0, target.vertex, target.displacement_mm, kUp);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_LE(fit->residual_mm, kReached_mm);
  EXPECT_NEAR(fit->X_LB.translation().z(), 1.2, 0.06);
  EXPECT_EQ(fit->X_LB.translation().x(), 0.0);
  EXPECT_FALSE(fit->is_at_limit);
}

/// The displacement of the result is that of the preview at the result's pose.
TEST(FitPreview, ReachesADisplacementAlongThreeAxes) {
  const predict::FacePreview preview = preview_of(test::block_on_slab());
  const Target target = target_at(preview, {0.3, -0.2, 0.8});
  const auto fit = fit_preview(preview, {shift({0.1, 0.0, 0.1})}, 0, target.vertex,
                               target.displacement_mm, kAllAxes);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_LE((fit->displacement_mm - target.displacement_mm).norm(), kReached_mm);
  const auto u_mm = preview.displacement_mm(std::array{fit->X_LB}).value();
  EXPECT_LT((u_mm[std::size_t(target.vertex)] - fit->displacement_mm).norm(), 0.01);
}

TEST(FitPreview, KeepsAPoseThatHasTheDisplacement) {
  const predict::FacePreview preview = preview_of(test::block_on_slab());
  const Target target = target_at(preview, {0.0, 0.0, 0.5});
  const auto fit = fit_preview(preview, {shift({0.0, 0.0, 0.5})}, 0, target.vertex,
                               target.displacement_mm, kAllAxes);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_EQ(fit->X_LB.translation(), Vec3(0.0, 0.0, 0.5));
}

TEST(FitPreview, RejectsWhatDoesNotExist) {
  const predict::FacePreview preview = preview_of(test::block_on_slab());
  const std::vector<RigidTransform> rest{RigidTransform::Identity()};
  const Vec3 up_mm = Vec3::UnitZ();
  const auto code_of = [&](std::size_t segment, Index vertex,
                           const Vec3& wanted_mm) -> std::optional<ErrorCode> {
    const auto fit = fit_preview(preview, rest, segment, vertex, wanted_mm, kUp);
    return fit ? std::nullopt : std::optional(fit.error().code);
  };
  EXPECT_EQ(code_of(1, 0, up_mm), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of(0, -1, up_mm), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of(0, preview.vertex_count(), up_mm), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of(0, 0, Vec3::Constant(std::numeric_limits<double>::quiet_NaN())),
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::inverse::test_fit_preview
