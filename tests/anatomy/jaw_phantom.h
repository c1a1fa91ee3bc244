/// \file
/// A skull and a mandible with teeth in occlusion and condyles in their fossae, as formulas.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/image/volume.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace lefort::test {

/// Depths are signed distances [mm], positive inside; the occlusal plane is z = 0 before the head is
/// tilted. Each condyle lies anterior in its fossa, where the joint space is 0.8 mm wide, less than a
/// voxel: there the threshold of bone connects both bones, over a narrower cross-section than that
/// of the ramus.
struct JawPhantom {
  double voxel_mm = 1.3;
  double pitch_deg = 0.0;    ///< Rotation of the head about x.
  double opening_deg = 0.0;  ///< Rotation of the mandible about its condyles.
  double enamel_hu = 2300.0;
  bool has_mandible = true;

  static constexpr double kBone_hu = 900.0, kDentin_hu = 1500.0, kSoft_hu = 40.0;
  static constexpr double kCondyle_mm = 6.5, kJointSpace_mm = 2.4, kAnterior_mm = 1.6;

  [[nodiscard]] static Vec3 condyle(double side) { return {47 * side, 18, 34}; }

  [[nodiscard]] static double capsule(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return radius - (p - a - t * (b - a)).norm();
  }
  /// Whether a point is within 3 mm of an arch or farther inside.
  [[nodiscard]] static bool is_near_arch(const Vec3& q) {
    return std::abs(q.x()) < 33.0 && q.y() > -72.0 && q.y() < -12.0 && q.z() > -3.0 && q.z() < 28.0;
  }
  /// A tooth of an arch: its axis crosses the occlusal plane here.
  [[nodiscard]] static Vec3 tooth_at(int tooth) {
    const double angle = (tooth - 6.5) / 6.5 * 0.5 * std::numbers::pi;
    return {25.0 * std::sin(angle), -20.0 - 43.0 * std::cos(angle), 0.0};
  }
  /// Crowns and roots of one jaw; side is 1 for the upper, -1 for the lower one.
  [[nodiscard]] static double teeth(const Vec3& p, double side) {
    const Vec3 q(p.x(), p.y(), side * p.z());
    if (!is_near_arch(q)) return -50.0;
    double depth = -50.0;
    for (int tooth = 0; tooth < 14; ++tooth) {
      const Vec3 at = tooth_at(tooth), up = Vec3::UnitZ();
      const double crown = capsule(q, at - 4.0 * up, at + 6.0 * up, 3.3);
      const double root = capsule(q, at + 6.0 * up, at + 18.0 * up, 2.2);
      depth = std::max({depth, std::min(crown, q.z()), root});
    }
    return depth;
  }
  [[nodiscard]] static double ridge(const Vec3& p, double side) {
    double depth = -50.0;
    if (!is_near_arch({p.x(), p.y(), side * p.z()})) return depth;
    for (int tooth = 0; tooth < 13; ++tooth)
      for (const double z : {14.0, 20.0}) {
        const Vec3 up = side * z * Vec3::UnitZ();
        depth = std::max(depth, capsule(p, tooth_at(tooth) + up, tooth_at(tooth + 1) + up, 5.0));
      }
    return depth;
  }
  [[nodiscard]] static double skull(const Vec3& p) {
    const double shell = 4.0 - std::abs((p - Vec3(0, 20, 85)).norm() - 65.0);
    double depth = std::max({shell, ridge(p, 1.0), teeth(p, 1.0)});
    for (const double x : {-1.0, 1.0}) {
      depth = std::max(depth, capsule(p, {22 * x, -45, 20}, {28 * x, -32, 52}, 5.0));
      const Vec3 joint = condyle(x);
      depth = std::max(depth, 8.0 - (p - joint - 14.0 * Vec3::UnitZ()).norm());
      const Vec3 fossa = joint - kAnterior_mm * Vec3(0.0, -0.6, 0.8);
      depth = std::min(depth, (p - fossa).norm() - kCondyle_mm - kJointSpace_mm);
    }
    return depth;
  }
  /// From the frame of the skull to that of the closed mandible.
  [[nodiscard]] Vec3 closed(const Vec3& p) const {
    const Vec3 joint = condyle(1.0);
    return joint + turned(-opening_deg) * (p - joint);
  }
  [[nodiscard]] double mandible(const Vec3& p_skull) const {
    if (!has_mandible) return -50.0;
    const Vec3 p = closed(p_skull);
    double depth = std::max(ridge(p, -1.0), teeth(p, -1.0));
    for (const double x : {-1.0, 1.0}) {
      depth = std::max(depth, capsule(p, {25 * x, -20, -18}, {44 * x, 14, -18}, 5.5));
      depth = std::max(depth, capsule(p, {44 * x, 14, -18}, {47 * x, 18, 28}, 4.5));
      depth = std::max(depth, kCondyle_mm - (p - condyle(x)).norm());
    }
    return depth;
  }
  /// Teeth of the lower jaw if `lower`, else of the upper one.
  [[nodiscard]] double teeth_of(const Vec3& p, bool lower) const {
    return lower ? has_mandible ? teeth(closed(p), -1.0) : -50.0 : teeth(p, 1.0);
  }
  /// A rotation about x that lowers what is anterior.
  [[nodiscard]] static Mat3 turned(double angle_deg) {
    return Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, Vec3::UnitX())
        .toRotationMatrix();
  }
  /// From L to the frame of the formulas.
  [[nodiscard]] Vec3 untilted(const Vec3& p_L) const { return turned(-pitch_deg) * p_L; }
  /// CT number at a point with these depths in skull, mandible, upper and lower teeth.
  [[nodiscard]] double hu(const Vec3& p, const std::array<float, 4>& depth) const {
    const auto fraction = [&](double d) { return std::clamp(0.5 + d / voxel_mm, 0.0, 1.0); };
    const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    double value = mix(-1000.0, kSoft_hu, fraction(92.0 - (p - Vec3(0, 20, 40)).norm()));
    value = mix(value, kBone_hu, std::min(1.0, fraction(depth[0]) + fraction(depth[1])));
    for (const std::size_t jaw : {2, 3}) {
      const double tooth = double(depth[jaw]);
      const double height = jaw == 3 ? -closed(p).z() : p.z();
      const bool enamel = height < 9.0 && tooth < 1.5;
      value = mix(value, enamel ? enamel_hu : std::min(kDentin_hu, enamel_hu), fraction(tooth));
    }
    return value;
  }
  [[nodiscard]] image::Grid grid() const {
    const auto voxels = [&](double mm) { return Index(mm / voxel_mm); };
    return {{voxels(150.0), voxels(180.0), voxels(150.0)},
            Vec3::Constant(voxel_mm),
            {-75.0, -80.0, -50.0},
            Mat3::Identity()};
  }
};

/// The scan of a phantom and, for each voxel, the depths in skull, mandible, upper and lower teeth.
struct JawScan {
  JawPhantom head;
  image::CtVolume ct;
  std::vector<std::array<float, 4>> depth;
  std::vector<Vec3> point;  ///< In the frame of the formulas.

  explicit JawScan(const JawPhantom& of) : head(of), ct{of.grid(), {}} {
    const image::Grid& grid = ct.grid;
    for (Index k = 0; k < grid.size[2]; ++k)
      for (Index j = 0; j < grid.size[1]; ++j)
        for (Index i = 0; i < grid.size[0]; ++i) {
          const Vec3 p = head.untilted(grid.point_L({double(i), double(j), double(k)}));
          point.push_back(p);
          depth.push_back({float(JawPhantom::skull(p)), float(head.mandible(p)),
                           float(head.teeth_of(p, false)), float(head.teeth_of(p, true))});
          ct.values.push_back(std::int16_t(std::lround(head.hu(p, depth.back()))));
        }
  }
};

}  // namespace lefort::test
