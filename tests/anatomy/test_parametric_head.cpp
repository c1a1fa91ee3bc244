#include <lefort/anatomy/parametric_head.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lefort::anatomy::test_parametric_head {
namespace {

/// In the frame of the head.
Vec3 landmark_of(const ParametricHead& head, const std::vector<NamedPoint>& all,
                 const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  EXPECT_NE(found, all.end()) << name;
  return found == all.end() ? Vec3::Zero() : Vec3(head.X_LH().inverse() * found->point_L);
}

/// Normal proportions of lips and teeth at rest \cite arnett1993: the upper incisors show by 2 to
/// 4 mm, the upper lip ends above the lower teeth, and its length is about half of that of the
/// lower lip and chin.
TEST(ParametricHead, TheLipsCloseAtTheUpperIncisors) {
  for (const std::uint64_t seed : {0, 104, 7001, 7002, 7003, 2001}) {
    const ParametricHead head(seed == 0 ? HeadShape{} : draw_head_shape(seed));
    const std::vector<NamedPoint> all = true_landmarks(head);
    const auto z = [&](const char* name) { return landmark_of(head, all, name).z(); };
    EXPECT_GE(z("Stm") - z("U1"), 2.0) << seed;
    EXPECT_LE(z("Stm") - z("U1"), 4.0) << seed;
    EXPECT_GT(z("L1"), z("U1")) << seed;  // An overbite.
    const double ratio = (z("Sn") - z("Stm")) / (z("Stm") - z("Me'"));
    EXPECT_GT(ratio, 0.4) << seed;
    EXPECT_LT(ratio, 0.7) << seed;
    // In order from above.
    const std::vector<std::string> order{"Prn", "Sn", "A'", "Ls", "Stm", "Li", "B'", "Pg'", "Me'"};
    for (std::size_t k = 1; k < order.size(); ++k)
      EXPECT_GT(z(order[k - 1].c_str()), z(order[k].c_str())) << seed << " " << order[k];
  }
}

/// An open bite: the mandible rotates about its condyles as a rigid body, the chin follows, and the
/// lips stay where they are.
TEST(ParametricHead, OpensTheBite) {
  const ParametricHead closed({});
  HeadShape shape;
  shape.opening_rad = 0.07;
  const ParametricHead open(shape);
  for (const Vec3& p :
       {Vec3(0, -91, -88), Vec3(0, -87, -49), Vec3(46, -20, -62), Vec3(50, -15, -6)})
    EXPECT_NEAR(open.mandible(open.opened(p)), closed.mandible(p), 1e-9) << p.transpose();
  const std::vector<NamedPoint> before = true_landmarks(closed), after = true_landmarks(open);
  const auto moved = [&](const char* name) {
    return Vec3(landmark_of(open, after, name) - landmark_of(closed, before, name));
  };
  EXPECT_NEAR(moved("Cdl-L").norm(), 0.0, 0.5);
  EXPECT_EQ(moved("U1").norm(), 0.0);
  EXPECT_EQ(moved("Stm").norm(), 0.0);
  EXPECT_NEAR(moved("L1").z(), -66.5 * std::sin(0.07),
              0.5);  // Its distance from the axis: 66.5 mm.
  EXPECT_NEAR(moved("Pg'").z(), moved("Pg").z(), 1.0);
  EXPECT_LT(landmark_of(open, after, "L1").z(), landmark_of(open, after, "U1").z());  // Open.
}

/// No tooth lies outside the skin, lips cover the front teeth, and tissue covers the mandible.
TEST(ParametricHead, TissueCoversTheJaws) {
  constexpr double kMin_mm = 0.3, kStep_mm = 1.5;
  for (const std::uint64_t seed : {0, 1, 104, 7001, 7002, 7003}) {
    HeadShape shape = seed < 2 ? HeadShape{} : draw_head_shape(seed);
    if (seed == 1) {
      shape.opening_rad = 0.07;
      shape.chin_mm.x() = 4.0;
    }
    const ParametricHead head(shape);
    for (double x = -72.0; x <= 72.0; x += kStep_mm)
      for (double y = -110.0; y <= -10.0; y += kStep_mm)
        for (double z = -105.0; z <= -5.0; z += kStep_mm) {
          const Vec3 p_L = head.X_LH() * head.from_mean({x, y, z});
          if (std::max(head.skull(p_L), head.mandible(p_L)) <= 0.0) continue;
          EXPECT_GT(head.skin(p_L), kMin_mm) << seed << ": " << x << " " << y << " " << z;
        }
  }
}

}  // namespace
}  // namespace lefort::anatomy::test_parametric_head
