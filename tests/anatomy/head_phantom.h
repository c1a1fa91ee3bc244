/// \file
/// A head made of spheres, truncated below, with known tissues everywhere.
///
///        _______         skin: a large ball (skull) and a small one (face)
///      /  _____  \       skull: a shell, with a round hole on the patient's right, in front
///     |  /     \  |      brain: all inside the shell
///     |  \_____/  | )    holder: an arc behind, not touching
///      \  _   _  /       sinus: a ball of air in a ball of bone, on the patient's left
///       \(_)-(_)/        pharynx and nostril: a ball of air and a tube to the front, on the right;
///         ‾‾‾‾‾          between sinus and pharynx a narrow ostium
#pragma once

#include <lefort/anatomy/label_map.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lefort::test {

struct HeadPhantom {
  Vec3 spacing_mm{1.8, 1.8, 2.2};
  bool has_table = false;  ///< A slab that touches the back of the head.

  static constexpr double kSkinRadius = 85.0;
  static constexpr double kOuterTable = 75.0;
  static constexpr double kInnerTable = 68.0;
  static constexpr double kDefectRadius = 12.0;
  static constexpr double kSinusRadius = 10.0;
  static constexpr double kSinusBone = 16.0;
  static constexpr double kNostrilRadius = 4.0;
  static constexpr double kBlur_mm = 1.5;  ///< Half the width of the gradient between two tissues.

  const Vec3 face{0.0, -55.0, -60.0};
  const Vec3 defect_axis = Vec3(-0.5, -std::sqrt(0.75), 0.0);
  const Vec3 sinus{15.0, -70.0, -62.0};
  const Vec3 pharynx{-12.0, -60.0, -72.0};
  const Vec3 nostril{-12.0, -120.0, -72.0};
  const Vec3 jaw{30.0, -50.0, -85.0};
  const Vec3 island{0.0, -81.0, -30.0};

  /// Signed distances [mm], positive inside.
  [[nodiscard]] double skin(const Vec3& p) const {
    return std::max(kSkinRadius - p.norm(), 50.0 - (p - face).norm());
  }
  [[nodiscard]] double defect(const Vec3& p) const {
    if (p.dot(defect_axis) < 0.0) return -50.0;
    return kDefectRadius - p.cross(defect_axis).norm();
  }
  [[nodiscard]] double shell(const Vec3& p) const {
    return std::min(kOuterTable - p.norm(), p.norm() - kInnerTable);
  }
  [[nodiscard]] double bone(const Vec3& p) const {
    return std::max(
        {std::min(shell(p), -defect(p)), kSinusBone - (p - sinus).norm(), 8.0 - (p - jaw).norm()});
  }
  [[nodiscard]] static double tube(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return radius - (p - a - t * (b - a)).norm();
  }
  [[nodiscard]] double airway(const Vec3& p) const {
    return std::max(9.0 - (p - pharynx).norm(), tube(p, pharynx, nostril, kNostrilRadius));
  }
  [[nodiscard]] double sinus_air(const Vec3& p) const { return kSinusRadius - (p - sinus).norm(); }
  [[nodiscard]] double holder(const Vec3& p) const {
    return p.y() < 20.0 ? p.y() - 20.0 : 2.0 - std::abs(p.head<2>().norm() - 100.0);
  }
  [[nodiscard]] double table(const Vec3& p) const {
    return has_table ? std::min(p.y() - 84.0, 100.0 - p.y()) : -50.0;
  }

  [[nodiscard]] std::int16_t hu(const Vec3& p) const {
    const auto fraction = [](double d) { return std::clamp(0.5 + 0.5 * d / kBlur_mm, 0.0, 1.0); };
    const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    double value = mix(-1000.0, 40.0, fraction(skin(p)));
    value = std::max(value, mix(-1000.0, 300.0, fraction(has_table ? table(p) : holder(p))));
    value = mix(value, 900.0, fraction(std::max(bone(p), 1.8 - (p - island).norm())));
    const double ostium = tube(p, sinus, pharynx, 1.2);
    value = mix(value, -1000.0, fraction(std::max({airway(p), sinus_air(p), ostium})));
    return std::int16_t(std::lround(value));
  }

  /// The tissue at p; nothing within `margin_mm` of a border.
  [[nodiscard]] std::optional<anatomy::Tissue> tissue(const Vec3& p, double margin_mm) const {
    using anatomy::Tissue;
    for (const double border :
         {skin(p), bone(p), airway(p), sinus_air(p), tube(p, sinus, pharynx, 1.2),
          kInnerTable - p.norm(), kOuterTable - p.norm(), (p - island).norm() - 1.8, table(p)})
      if (std::abs(border) < margin_mm) return {};
    if (skin(p) < 0.0) return Tissue::kBackground;
    if (airway(p) > 0.0) {
      // The border between nostril and outside is a matter of definition.
      if (p.y() < -90.0) return {};
      return Tissue::kAirway;
    }
    if (sinus_air(p) > 0.0) return Tissue::kSinus;
    if (tube(p, sinus, pharynx, 1.2) > 0.0) return {};
    if (bone(p) > 0.0) return Tissue::kBone;
    if (p.norm() < kInnerTable) return Tissue::kBrain;
    // In the hole the brain ends somewhere between the tables.
    if (p.norm() < kOuterTable) return {};
    return Tissue::kSoftTissue;
  }

  /// The scan on a grid with axes `direction`; it covers x, y of +-108 mm and z of -96 to 91 mm and
  /// so truncates the face below.
  [[nodiscard]] image::CtVolume scan(const Mat3& direction = Mat3::Identity()) const {
    const Vec3 low(-108.0, -111.6, -96.0);  // A whole number of voxels from high.
    const Vec3 high(108.0, 108.0, 91.0);
    image::CtVolume ct;
    image::Grid& grid = ct.grid;
    grid.direction = direction;
    grid.spacing_mm = (direction.cwiseAbs().transpose() * spacing_mm);
    Vec3 first;  // Along the axes of the grid.
    for (Index axis = 0; axis < 3; ++axis) {
      const double a = direction.col(axis).dot(low);
      const double b = direction.col(axis).dot(high);
      first[axis] = std::min(a, b);
      grid.size[std::size_t(axis)] =
          Index(std::lround(std::abs(b - a) / grid.spacing_mm[axis])) + 1;
    }
    grid.origin_L = direction * first;
    for (Index k = 0; k < grid.size[2]; ++k)
      for (Index j = 0; j < grid.size[1]; ++j)
        for (Index i = 0; i < grid.size[0]; ++i)
          ct.values.push_back(hu(grid.point_L({double(i), double(j), double(k)})));
    return ct;
  }
};

}  // namespace lefort::test
