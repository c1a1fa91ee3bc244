#include <lefort/report/view.h>

#include <gtest/gtest.h>

#include <limits>

namespace lefort::report::test_view {
namespace {

const Vec3 kLeft_L(1.0, 0.0, 0.0);
const Vec3 kFront_L(0.0, -1.0, 0.0);
const Vec3 kTop_L(0.0, 0.0, 1.0);
const Box3 kHead_L(Vec3(-80.0, -100.0, -110.0), Vec3(80.0, 100.0, 120.0));
constexpr double kAspect = 1.2;

ViewAxes axes(StandardView view) { return axes_of(standard_view(view, kHead_L, kAspect)); }

TEST(View, FrontShowsThePatientsRightOnTheLeft) {
  EXPECT_TRUE(axes(StandardView::kFront).right_L.isApprox(kLeft_L));
  EXPECT_TRUE(axes(StandardView::kFront).towards_L.isApprox(kFront_L));
}

TEST(View, ProfilesShowTheirSide) {
  EXPECT_TRUE(axes(StandardView::kRightProfile).towards_L.isApprox(-kLeft_L));
  EXPECT_TRUE(axes(StandardView::kRightProfile).right_L.isApprox(kFront_L));
  EXPECT_TRUE(axes(StandardView::kLeftProfile).towards_L.isApprox(kLeft_L));
  EXPECT_TRUE(axes(StandardView::kLeftProfile).right_L.isApprox(-kFront_L));
}

TEST(View, ThreeQuarterViewsShowTheFrontAndTheirSide) {
  const ViewAxes left = axes(StandardView::kLeftThreeQuarter);
  EXPECT_TRUE(left.towards_L.isApprox((kLeft_L + kFront_L).normalized()));
  const ViewAxes right = axes(StandardView::kRightThreeQuarter);
  EXPECT_TRUE(right.towards_L.isApprox((kFront_L - kLeft_L).normalized()));
}

TEST(View, AxesAreRightHandedAndUpIsSuperior) {
  for (const StandardView view :
       {StandardView::kFront, StandardView::kRightProfile, StandardView::kLeftProfile,
        StandardView::kRightThreeQuarter, StandardView::kLeftThreeQuarter}) {
    const ViewAxes a = axes(view);
    EXPECT_TRUE(a.right_L.cross(a.up_L).isApprox(a.towards_L)) << name_of(view);
    EXPECT_TRUE(a.up_L.isApprox(kTop_L)) << name_of(view);
  }
}

TEST(View, FitsTheBoxByItsLongerSide) {
  // 230 mm of head height decide when the picture is wide, 160 mm of width when it is narrow.
  EXPECT_GT(standard_view(StandardView::kFront, kHead_L, kAspect).height_mm, 230.0);
  EXPECT_LT(standard_view(StandardView::kFront, kHead_L, kAspect).height_mm, 1.2 * 230.0);
  EXPECT_GT(standard_view(StandardView::kFront, kHead_L, 0.4).height_mm, 160.0 / 0.4);
  EXPECT_LT(standard_view(StandardView::kFront, kHead_L, 0.4).height_mm, 1.2 * 160.0 / 0.4);
}

TEST(View, LabelsTheSidesOfThePatient) {
  EXPECT_EQ(orientation_letters(kLeft_L), "L");
  EXPECT_EQ(orientation_letters(-kLeft_L), "R");
  EXPECT_EQ(orientation_letters(kFront_L), "A");
  EXPECT_EQ(orientation_letters(-kFront_L), "P");
  EXPECT_EQ(orientation_letters(kTop_L), "S");
  EXPECT_EQ(orientation_letters(-kTop_L), "I");
  EXPECT_EQ(orientation_letters(Vec3(1.0, -0.6, 0.1)), "LA");
  EXPECT_EQ(orientation_letters(Vec3(0.1, -0.2, -1.0)), "I");
}

TEST(View, RejectsAViewWithoutDirection) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(check_view(View{}));
  for (const View& view : {View{.direction_L = Vec3::Zero()}, View{.up_L = Vec3(0.0, -3.0, 0.0)},
                           View{.height_mm = 0.0}, View{.center_L = Vec3(kNan, 0.0, 0.0)}})
    EXPECT_EQ(check_view(view).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::report::test_view
