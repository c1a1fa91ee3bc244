// A synthetic head with teeth: they are found, numbered, and registered with their scans; the
// occlusion that they were made for is found.
#include <lefort/anatomy/intraoral_scan.h>
#include <lefort/core/units.h>
#include <lefort/dental/find_occlusion.h>
#include <lefort/dental/number_teeth.h>
#include <lefort/dental/register_arch.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace lefort::dental::test_dentition_head {
namespace {

using anatomy::HeadShape;
using anatomy::ParametricHead;
using anatomy::Tooth;

/// The mandible is behind occlusion and to the left, and the mouth is open.
HeadShape shape() {
  HeadShape s;
  s.dentition = 3;
  s.jaw_offset_mm = Vec3(1.5, 4.0, 0.0);
  s.opening_rad = anatomy::opening_with_clearance(s, 1.0);
  return s;
}

double max_miss_mm(const geometry::TriangleMesh& mesh, const RigidTransform& X,
                   const RigidTransform& truth) {
  double miss_mm = 0.0;
  for (const Vec3& p : mesh.vertices) miss_mm = std::max(miss_mm, (X * p - truth * p).norm());
  return miss_mm;
}

double turn_deg(const RigidTransform& X, const RigidTransform& truth) {
  return degrees_from_radians(
      geometry::rotation_vector(Mat3(X.linear() * truth.linear().transpose())).norm());
}

TEST(DentitionHead, occludes_as_class_I) {
  const ParametricHead head(shape());
  const anatomy::Dentition& teeth = head.dentition();
  EXPECT_EQ(teeth.teeth().size(), 28U);
  const auto tip = [&](int fdi) { return teeth.tooth(fdi).tip_M(); };
  const Vec3 incisors = 0.5 * (tip(11) + tip(21) - tip(41) - tip(31));
  EXPECT_NEAR(-incisors.y(), 2.0, 0.5);  // Overjet, between the middles of the edges.
  EXPECT_NEAR(-incisors.z(), 2.1, 0.4);  // Overbite.
  // The mesiobuccal cusp of 16 bites between the buccal cusps of 46; 13 between 43 and 44.
  EXPECT_GT(tip(16).y(), tip(46).y());
  EXPECT_LT(tip(16).y(), (teeth.tooth(46).origin_M).y() + 1.0);
  EXPECT_GT(tip(13).y(), tip(43).y());
  EXPECT_LT(tip(13).y(), tip(44).y());
  // No tooth is in another one, and they touch: in the fissures of the upper molars and premolars.
  Index touching = 0;
  for (double x = -33.0; x < 33.0; x += 0.5)
    for (double y = -98.0; y < -48.0; y += 0.5)
      for (double z = -54.0; z < -47.0; z += 0.05) {
        const double both =
            std::min(teeth.upper({x, y, z}).tooth + 0.01, teeth.lower({x, y, z}).tooth + 0.01);
        EXPECT_LE(both, 1e-9);
        touching += both > -0.05 ? 1 : 0;
      }
  EXPECT_GT(touching, 100);
}

TEST(DentitionHead, teeth_are_numbered_and_scans_registered) {
  const ParametricHead head(shape());
  constexpr double kVoxel_mm = 0.6, kBone_hu = 300.0;
  const auto scan =
      anatomy::scan_of(head, Box3(Vec3(-42, -112, -84), Vec3(42, -30, -22)), kVoxel_mm, 12.0, 7);
  const anatomy::ToothMap teeth = anatomy::find_teeth(scan.ct, scan.labels, kBone_hu);
  const NumberedTeeth numbered = number_teeth(teeth, DentalFrame{});
  EXPECT_EQ(numbered.teeth.size(), 28U);
  EXPECT_TRUE(numbered.missing.empty());
  for (const NumberedTooth& found : numbered.teeth) {
    const anatomy::ToothForm& tooth = head.dentition().tooth(found.fdi);
    EXPECT_LT((found.crown_L - head.from_tooth_L(tooth, tooth.crown_M())).norm(), 3.0) << found.fdi;
  }
  std::array<geometry::TriangleMesh, 2> arches_L;
  for (const bool is_upper : {true, false}) {
    const auto arch_L = anatomy::scanned_arch(head, is_upper, 0.4, 0.03, 5);
    ASSERT_TRUE(arch_L) << arch_L.error().message;
    RigidTransform X_scan_L = RigidTransform::Identity();
    X_scan_L.linear() =
        Eigen::AngleAxisd(2.0, Vec3(1, is_upper ? 2 : -1, 1).normalized()).toRotationMatrix();
    X_scan_L.translation() = Vec3(10, 40, -60);
    const auto crowns = find_crowns(scan.ct, teeth, is_upper ? Tooth::kUpper : Tooth::kLower);
    ASSERT_TRUE(crowns) << crowns.error().message;
    const geometry::TriangleMesh file = geometry::transformed(*arch_L, X_scan_L);
    const auto fit = register_arch(file, *crowns, nullptr);
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_LT(max_miss_mm(file, fit->X_L_scan, X_scan_L.inverse()), 0.05) << is_upper;
    EXPECT_LT(turn_deg(fit->X_L_scan, X_scan_L.inverse()), 0.1) << is_upper;
    arches_L[is_upper ? 0 : 1] = geometry::transformed(file, fit->X_L_scan);
  }
  const auto occlusion = find_occlusion(arches_L[0], arches_L[1], ArchAxes{});
  ASSERT_TRUE(occlusion) << occlusion.error().message;
  EXPECT_LT(max_miss_mm(arches_L[1], occlusion->X_L_lower, head.X_occlusion_L()), 0.3);
  EXPECT_LT(turn_deg(occlusion->X_L_lower, head.X_occlusion_L()), 0.5);
}

}  // namespace
}  // namespace lefort::dental::test_dentition_head
