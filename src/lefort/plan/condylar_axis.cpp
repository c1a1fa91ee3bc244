#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/plan/condylar_axis.h>
#include <lefort/plan/make_keyframes.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace lefort::plan {

namespace {

/// The pose X_LB after autorotation and then the motion of a keyframe, whose center is given before
/// the autorotation.
RigidTransform pose_after(const CondylarAxis& axis, double closing_deg,
                          const geometry::Keyframe& then) {
  const RigidTransform closed = autorotation(axis, closing_deg);
  return geometry::rigid_motion(then.translation_mm, then.rotation_rad, closed * then.center_L) *
         closed;
}

}  // namespace

Result<CondylarAxis> condylar_axis(std::span<const Landmark> landmarks) {
  constexpr double kMinDistance_mm = 50.0;  // Of the condyles; 70 mm in a child.
  const auto bad = [](std::string what) { return fail(ErrorCode::kPlanInvalid, std::move(what)); };
  LEFORT_TRY_VOID(patient_left_axis(landmarks));
  std::array<Vec3, 2> centers_L{Vec3::Zero(), Vec3::Zero()};
  for (std::size_t side = 0; side < 2; ++side)
    for (const char* const pole : {"Cdl", "Cdm"}) {
      const std::string name = pole + std::string(side == 0 ? "-R" : "-L");
      const auto p_L = find_landmark(landmarks, name);
      if (!p_L)
        return bad(fmt::format("the axis of the condyles needs landmark {} ({}), which is missing",
                               name, full_name(name)));
      centers_L[side] += 0.5 * *p_L;
    }
  const double distance_mm = (centers_L[1] - centers_L[0]).norm();
  if (!(distance_mm >= kMinDistance_mm))
    return bad(fmt::format("the centers of the condyles are {:.1f} mm apart, must be {:g} or more",
                           distance_mm, kMinDistance_mm));
  return CondylarAxis{centers_L[0], centers_L[1]};
}

RigidTransform autorotation(const CondylarAxis& axis, double closing_deg) {
  const Vec3 left = (axis.left_L - axis.right_L).normalized();
  // Right-handed about the left axis, the anterior part moves down: opening.
  const Mat3 turn = Eigen::AngleAxisd(-radians_from_degrees(closing_deg), left).toRotationMatrix();
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.linear() = turn;
  X_LB.translation() = axis.middle_L() - turn * axis.middle_L();
  return X_LB;
}

geometry::Keyframe after_autorotation(const CondylarAxis& axis, double closing_deg,
                                      const geometry::Keyframe& then) {
  geometry::Keyframe both = keyframe_of_pose(pose_after(axis, closing_deg, then), then.center_L);
  both.path_fraction = then.path_fraction;
  return both;
}

Result<std::vector<Vec3>> points_of_lower_teeth(const geometry::TriangleMesh& mandible_L,
                                                std::span<const Landmark> landmarks) {
  constexpr double kBelow_mm = 8.0, kBehind_mm = 15.0;
  std::array<Vec3, 3> teeth_L;
  const std::array<const char*, 3> names{"L1", "L6-R", "L6-L"};
  for (std::size_t n = 0; n < names.size(); ++n) {
    const auto p_L = find_landmark(landmarks, names[n]);
    if (!p_L)
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("a gap between the teeth needs landmark {} ({}), which is missing",
                              names[n], full_name(names[n])));
    teeth_L[n] = *p_L;
  }
  const auto& [incisor_L, right_L, left_L] = teeth_L;
  const Vec3 left = (left_L - right_L).normalized();
  Vec3 behind = 0.5 * (right_L + left_L) - incisor_L;
  behind -= left.dot(behind) * left;
  const double depth_mm = behind.norm() + kBehind_mm;
  behind.normalize();
  const Vec3 up = behind.cross(left).z() > 0.0 ? behind.cross(left) : left.cross(behind);
  std::vector<Vec3> points_L;
  for (const Vec3& p_L : mandible_L.vertices)
    if (up.dot(p_L - incisor_L) > -kBelow_mm && behind.dot(p_L - incisor_L) < depth_mm)
      points_L.push_back(p_L);
  if (points_L.empty())
    return fail(ErrorCode::kPlanInvalid, "the mandible has no teeth at landmarks L1 and L6");
  return points_L;
}

Result<double> closing_to_gap(const CondylarAxis& axis, std::span<const Vec3> lower_L,
                              std::span<const UpperBone> upper, double gap_mm,
                              const geometry::Keyframe& then) {
  constexpr double kLimit_deg = 20.0, kStep_deg = 1.0, kTolerance_deg = 1e-3;
  LEFORT_CHECK(!upper.empty() && !lower_L.empty());
  const auto clearance_mm = [&](double closing_deg) {
    const RigidTransform X_L_lower = pose_after(axis, closing_deg, then);
    std::vector<double> distances_mm(lower_L.size());
    parallel_for(Index(lower_L.size()), [&](Index n) {
      const Vec3 p_L = X_L_lower * lower_L[std::size_t(n)];
      double nearest_mm = std::numeric_limits<double>::infinity();
      for (const UpperBone& bone : upper)
        nearest_mm = std::min(
            nearest_mm, bone.surface_B.signed_distance(bone.X_LB.inverse() * p_L).distance_mm);
      distances_mm[std::size_t(n)] = nearest_mm;
    });
    return *std::min_element(distances_mm.begin(), distances_mm.end());
  };
  const auto bad = [&](const char* what) {
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("autorotation to a gap of {:g} mm: {}", gap_mm, what));
  };
  double open_deg = -kLimit_deg;
  if (!(clearance_mm(open_deg) > gap_mm)) return bad("the teeth do not separate by 20 degrees");
  double closed_deg = open_deg + kStep_deg;
  while (clearance_mm(closed_deg) > gap_mm) {
    open_deg = closed_deg;
    closed_deg += kStep_deg;
    if (closed_deg > kLimit_deg) return bad("the teeth do not meet by 20 degrees");
  }
  while (closed_deg - open_deg > kTolerance_deg) {
    const double middle_deg = 0.5 * (open_deg + closed_deg);
    (clearance_mm(middle_deg) > gap_mm ? open_deg : closed_deg) = middle_deg;
  }
  return open_deg;
}

}  // namespace lefort::plan
