#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/dental/register_bite.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "dental/arch.h"

namespace lefort::dental {
namespace {

geometry::TriangleMesh bitten_lower() {
  return test::make_arch({.seed = 3.0, .step_mm = 0.6, .skirt_mm = 2.0});
}
/// Crowns with cheek sides, turned over, 1 mm above the lower ones.
geometry::TriangleMesh bitten_upper() {
  RigidTransform X(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitY()));
  X.translation() = Vec3(0.0, 0.0, 14.0);
  return geometry::transformed(test::make_arch({.seed = 8.0, .step_mm = 0.6, .skirt_mm = 2.0}), X);
}

/// What a scanner sees from the cheek: on both sides, or on one of them.
geometry::TriangleMesh bite_of(const geometry::TriangleMesh& arch, int side) {
  const Vec3 center(0.0, 25.0, 0.0);
  return geometry::keep_triangles(arch, [&](Index t) {
    const Vec3 &a = arch.corner(t, 0), &b = arch.corner(t, 1), &c = arch.corner(t, 2);
    Vec3 outward = a - center;
    outward.z() = 0.0;
    const bool is_seen = (b - a).cross(c - a).normalized().dot(outward.normalized()) > 0.15;
    return is_seen && (side == 0 || side * a.x() > 5.0);
  });
}

geometry::TriangleMesh both(geometry::TriangleMesh a, const geometry::TriangleMesh& b) {
  const auto first = std::int32_t(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles)
    a.triangles.push_back({i + first, j + first, k + first});
  return a;
}

RigidTransform motion(const Vec3& turn_deg, const Vec3& shift) {
  return geometry::rigid_motion(shift, turn_deg * radians_from_degrees(1.0), Vec3::Zero());
}

double worst_mm(const RigidTransform& found, const RigidTransform& wanted,
                const geometry::TriangleMesh& arch) {
  double worst = 0.0;
  for (const Vec3& p : arch.vertices) worst = std::max(worst, (found * p - wanted * p).norm());
  return worst;
}

TEST(RegisterBite, finds_the_occlusion_from_any_frame) {
  const auto upper = bitten_upper(), lower = bitten_lower();
  const auto seen = both(bite_of(upper, 0), bite_of(lower, 0));
  // The jaws are open in the CT.
  const RigidTransform X_open = motion({6.0, 1.0, -2.0}, {1.5, 2.0, -7.0});
  const auto opened = geometry::transformed(lower, X_open);
  for (const Vec3& turn : {Vec3(100.0, 50.0, -70.0), Vec3(0.0, 170.0, 40.0)}) {
    const auto bite = geometry::transformed(seen, motion(turn, {60.0, -20.0, 45.0}));
    const auto found = register_bite(upper, opened, {}, {&bite, 1});
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_LT(worst_mm(found->X_L_lower, X_open.inverse(), opened), 0.05);
    ASSERT_EQ(found->fits.size(), 1U);
    EXPECT_GT(found->fits[0].fraction, 0.95);
    EXPECT_LT(found->fits[0].upper_rms_mm, 0.02);
  }
}

TEST(RegisterBite, joins_the_scans_of_both_sides) {
  const auto upper = bitten_upper(), lower = bitten_lower();
  const RigidTransform X_open = motion({3.0, 0.0, 2.0}, {0.0, 1.0, -4.0});
  const auto opened = geometry::transformed(lower, X_open);
  std::vector<geometry::TriangleMesh> bites;
  for (const int side : {-1, 1})
    bites.push_back(
        geometry::transformed(both(bite_of(upper, side), bite_of(lower, side)),
                              motion({0.0, 80.0 * side, 30.0}, {10.0 * side, 0.0, 9.0})));
  const auto found = register_bite(upper, opened, {}, bites);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(worst_mm(found->X_L_lower, X_open.inverse(), opened), 0.1);
  const ThreadLimit limit(1);
  const auto again = register_bite(upper, opened, {}, bites);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->X_L_lower.matrix(), found->X_L_lower.matrix());
}

TEST(RegisterBite, refuses_scans_of_different_occlusions) {
  const auto upper = bitten_upper(), lower = bitten_lower();
  const auto other = geometry::transformed(lower, motion({0.0, 0.0, 0.0}, {0.0, -2.5, -1.5}));
  const std::vector<geometry::TriangleMesh> bites{both(bite_of(upper, -1), bite_of(lower, -1)),
                                                  both(bite_of(upper, 1), bite_of(other, 1))};
  const auto found = register_bite(upper, lower, {}, bites);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kNotConverged) << found.error().message;
}

TEST(RegisterBite, refuses_what_does_not_fit) {
  const auto upper = bitten_upper(), lower = bitten_lower();
  const auto bite = both(bite_of(upper, 0), bite_of(lower, 0));
  const auto refused = [&](geometry::TriangleMesh scan, ErrorCode code, const std::string& why) {
    const auto found = register_bite(upper, lower, {}, {&scan, 1});
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, code) << found.error().message;
    EXPECT_NE(found.error().message.find(why), std::string::npos) << found.error().message;
  };
  geometry::TriangleMesh meters = bite;
  for (Vec3& p : meters.vertices) p *= 1e-3;
  refused(meters, ErrorCode::kInvalidArgument, "is it in mm?");
  const auto other = test::make_arch({.seed = 21.0, .step_mm = 0.6});
  refused(both(bite_of(other, 0),
               geometry::transformed(bite_of(other, 0), motion({180.0, 0.0, 0.0}, {0, 50, 14}))),
          ErrorCode::kNotConverged, "of the bite scan lies on the arches");
  EXPECT_FALSE(register_bite(upper, lower, {}, {}));
}

}  // namespace
}  // namespace lefort::dental
