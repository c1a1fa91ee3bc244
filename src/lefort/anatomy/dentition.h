/// \file
/// Two synthetic dental arches that intercuspate, with crowns, cusps and roots of published sizes.
#pragma once

#include <lefort/core/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::anatomy {

/// Level-set functions of the teeth of one jaw at a point, positive inside [mm]. Far from the teeth
/// they are negative, not distances.
struct ToothLevels {
  double tooth = -20.0;   ///< Crowns and roots.
  double dentin = -20.0;  ///< The same below the enamel.
  double socket = -20.0;  ///< The alveolar process around the roots.
};

/// A cusp in the frame of its tooth: mesial and buccal of the axis, and its height below the tip.
struct Cusp {
  double distal_mm = 0.0, buccal_mm = 0.0, below_mm = 0.0;
};

/// One tooth. Its frame: the origin in the middle of the neck; columns of `axes` to distal, to
/// buccal, and along the axis to the crown. On the left side it is left-handed.
struct ToothForm {
  int fdi = 0;                     ///< ISO 3950.
  double crown_mm = 0.0;           ///< From the neck to the tip.
  double root_mm = 0.0;            ///< From the neck to the apex.
  double width_mm = 0.0;           ///< Mesiodistal, of the crown.
  double neck_width_mm = 0.0;      ///< Mesiodistal, of the neck.
  double depth_mm = 0.0;           ///< Buccolingual, of the crown.
  double neck_depth_mm = 0.0;      ///< Buccolingual, of the neck.
  std::vector<Cusp> cusps;         ///< Empty: an incisor.
  Vec3 origin_M = Vec3::Zero();    ///< In the frame of the dentition.
  Mat3 axes_M = Mat3::Identity();  ///< In the frame of the dentition.
  bool is_upper = false;

  /// The middle of the crown, between neck and tip.
  [[nodiscard]] Vec3 crown_M() const { return origin_M + 0.5 * crown_mm * axes_M.col(2); }
  /// The tip of the first cusp, which is the mesiobuccal one, or the middle of the incisal edge.
  [[nodiscard]] Vec3 tip_M() const;
};

/// The 28 teeth of an adult without third molars, in occlusion, class I.
///
/// Widths, depths, crown heights and root lengths are the means of \cite nelson2010, from
/// memory. Teeth of one arch touch at their contacts on an ellipse. The upper crowns, grown by
/// 0.02 mm, are cut out of the lower ones, which reach up to half a millimeter into them:
/// facets on which both arches touch by construction. Sections of crowns are superellipses;
/// cusps are rounded cones; molars have two or three roots. There is no pulp and no periodontal
/// ligament.
///
/// Frame M: that of the mean head (parametric_head.h), x to the patient's left, y to posterior, z
/// to superior.
class Dentition {
 public:
  /// \param seed  of small rotations, inclinations and cusp heights, which differ between sides.
  explicit Dentition(std::uint64_t seed);

  [[nodiscard]] ToothLevels upper(const Vec3& p_M) const;
  /// In occlusion.
  [[nodiscard]] ToothLevels lower(const Vec3& p_M) const;
  /// Uppers, then lowers, each from right to left.
  [[nodiscard]] std::span<const ToothForm> teeth() const { return teeth_; }
  /// \pre there is such a tooth.
  [[nodiscard]] const ToothForm& tooth(int fdi) const;

 private:
  std::vector<ToothForm> teeth_;
};

}  // namespace lefort::anatomy
