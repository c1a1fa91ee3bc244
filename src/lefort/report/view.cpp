#include <lefort/core/check.h>
#include <lefort/report/view.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lefort::report {

namespace {

/// Empty margin around the focus, as a fraction of its size.
constexpr double kFocusMargin = 0.06;

Vec3 direction_of(StandardView view) {  // From the camera to the patient, LPS.
  switch (view) {
    case StandardView::kFront:
      return {0.0, 1.0, 0.0};
    case StandardView::kRightProfile:
      return {1.0, 0.0, 0.0};
    case StandardView::kLeftProfile:
      return {-1.0, 0.0, 0.0};
    case StandardView::kRightThreeQuarter:
      return Vec3(1.0, 1.0, 0.0).normalized();
    case StandardView::kLeftThreeQuarter:
      return Vec3(-1.0, 1.0, 0.0).normalized();
  }
  LEFORT_CHECK(false);
  std::abort();
}

}  // namespace

const char* name_of(StandardView view) {
  switch (view) {
    case StandardView::kFront:
      return "front";
    case StandardView::kRightProfile:
      return "right profile";
    case StandardView::kLeftProfile:
      return "left profile";
    case StandardView::kRightThreeQuarter:
      return "right three-quarter";
    case StandardView::kLeftThreeQuarter:
      return "left three-quarter";
  }
  return "";
}

View standard_view(StandardView standard, const Box3& focus_L, double aspect) {
  LEFORT_CHECK(!focus_L.isEmpty() && aspect > 0.0);
  View view{.direction_L = direction_of(standard), .center_L = focus_L.center()};
  const ViewAxes axes = axes_of(view);
  const Vec3 sizes_mm = focus_L.sizes();
  const double width_mm = axes.right_L.cwiseAbs().dot(sizes_mm);
  const double height_mm = axes.up_L.cwiseAbs().dot(sizes_mm);
  const double min_mm = 1.0;  // The box may be a point.
  view.height_mm = std::max({height_mm, width_mm / aspect, min_mm}) * (1.0 + 2.0 * kFocusMargin);
  return view;
}

Result<void> check_view(const View& view) {
  const bool finite = view.direction_L.allFinite() && view.up_L.allFinite() &&
                      view.center_L.allFinite() && std::isfinite(view.height_mm);
  if (!finite) return fail(ErrorCode::kInvalidArgument, "view has a number that is not finite");
  if (view.height_mm <= 0.0)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("view shows {} mm of height, must be > 0", view.height_mm));
  const double lengths = view.direction_L.norm() * view.up_L.norm();
  const double sine = view.direction_L.cross(view.up_L).norm() / lengths;
  if (!(sine > 1e-6))  // Also if a length is zero.
    return fail(ErrorCode::kInvalidArgument,
                "viewing and upward direction of the view are parallel, or one of them is zero");
  return {};
}

ViewAxes axes_of(const View& view) {
  const Vec3 towards_L = -view.direction_L.normalized();
  const Vec3 right_L = view.up_L.cross(towards_L).normalized();
  return {right_L, towards_L.cross(right_L), towards_L};
}

std::string orientation_letters(const Vec3& edge_L) {
  struct Side {
    double fraction;
    char letter;
  };
  std::array<Side, 3> sides{{{std::abs(edge_L.x()), edge_L.x() > 0.0 ? 'L' : 'R'},
                             {std::abs(edge_L.y()), edge_L.y() > 0.0 ? 'P' : 'A'},
                             {std::abs(edge_L.z()), edge_L.z() > 0.0 ? 'S' : 'I'}}};
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return a.fraction > b.fraction; });
  std::string letters(1, sides[0].letter);
  const double oblique = 0.35;  // tan(19 deg): a slightly tilted head has one letter.
  if (sides[1].fraction > oblique * sides[0].fraction) letters += sides[1].letter;
  return letters;
}

}  // namespace lefort::report
