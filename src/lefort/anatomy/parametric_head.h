/// \file
/// A synthetic head with orbits, nose, palate, teeth and lips, whose shape follows parameters and
/// whose landmarks are known: the ground truth of automatic landmarks.
///
/// Unlike synthetic_head.h it has the concavities and ridges by which landmarks are defined.
#pragma once

#include <lefort/anatomy/dentition.h>
#include <lefort/anatomy/head_from_surfaces.h>
#include <lefort/core/types.h>
#include <lefort/image/volume.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lefort::anatomy {

/// Parameters of a head. Lengths are differences from the mean head [mm], before the scale. The x
/// of nasion_mm, anterior_spine_mm, upper_incisors_mm and nose_mm has no effect; x is to the
/// patient's
/// left, y to posterior, z to superior.
struct HeadShape {
  Vec3 scale = Vec3::Ones();  ///< Along x, y and z.
  Vec3 nasion_mm = Vec3::Zero();
  Vec3 anterior_spine_mm = Vec3::Zero();
  Vec3 upper_incisors_mm = Vec3::Zero();  ///< The lips follow; the lower incisors do not move.
  Vec3 chin_mm = Vec3::Zero();            ///< Its x: the chin deviates to the left.
  Vec3 gonion_mm = Vec3::Zero();          ///< x is lateral on both sides.
  Vec3 nose_mm = Vec3::Zero();            ///< Of the tip.
  double zygion_mm = 0.0;                 ///< Lateral, on both sides.
  double orbit_mm = 0.0;                  ///< Half height.
  double lips_mm = 0.0;                   ///< Anterior, relative to the incisors.
  double palate_mm = 0.0;                 ///< Length.
  /// Of the mandible about its condyles, 0 to 0.1: an open bite. The chin follows, the lips do not.
  /// A rotation before the scale.
  double opening_rad = 0.0;
  Vec3 rotation_rad = Vec3::Zero();  ///< Rotation vector of the head in the scan.
  Vec3 translation_mm = Vec3::Zero();
  /// Seed of the teeth (dentition.h), which then move with upper_incisors_mm in both jaws; 0:
  /// ridges instead of teeth. With teeth the opening is a rigid motion after the scale.
  std::uint64_t dentition = 0;
  /// With teeth: the lower ones and the body of the mandible, from occlusion; the rami stay. The
  /// rotation is about the middle of the lower arch. Both are after the scale, before the opening.
  Vec3 jaw_offset_mm = Vec3::Zero();
  Vec3 jaw_rotation_rad = Vec3::Zero();
};

/// A random shape: uniform within heuristic limits, which include the standard deviations of adult
/// faces \cite farkas1994; each component of the rotation vector is at most 10 degrees.
[[nodiscard]] HeadShape draw_head_shape(std::uint64_t seed);

/// The surfaces of a head as level-set functions, positive inside [mm]. Without scale and away from
/// fillets, the value near a surface is the distance to it, to first order.
class ParametricHead {
 public:
  explicit ParametricHead(const HeadShape& shape);

  [[nodiscard]] double skin(const Vec3& p_L) const;
  [[nodiscard]] double skull(const Vec3& p_L) const;     ///< With the upper teeth.
  [[nodiscard]] double mandible(const Vec3& p_L) const;  ///< With the lower teeth.

  /// The frame of the head: x to the left, y to posterior, z to superior; the origin is between the
  /// ears.
  [[nodiscard]] const RigidTransform& X_LH() const { return X_LH_; }
  [[nodiscard]] const HeadShape& shape() const { return shape_; }
  /// Applies only the scale to a point of the mean head, not the other parameters. \returns the
  /// point in frame H.
  [[nodiscard]] Vec3 from_mean(const Vec3& mean) const { return mean.cwiseProduct(shape_.scale); }
  /// Moves a point of the mandible of the mean head by HeadShape::opening_rad, and with teeth by
  /// HeadShape::jaw_offset_mm and jaw_rotation_rad.
  [[nodiscard]] Vec3 opened(const Vec3& mean) const;

  /// Whether the head has teeth (HeadShape::dentition). \pre of what follows.
  [[nodiscard]] bool has_dentition() const { return teeth_ != nullptr; }
  [[nodiscard]] const Dentition& dentition() const { return *teeth_; }
  [[nodiscard]] ToothLevels upper_teeth(const Vec3& p_L) const;
  [[nodiscard]] ToothLevels lower_teeth(const Vec3& p_L) const;
  [[nodiscard]] double skull_bone(const Vec3& p_L) const;     ///< Without teeth.
  [[nodiscard]] double mandible_bone(const Vec3& p_L) const;  ///< Without teeth.
  [[nodiscard]] double pharynx(const Vec3& p_L) const;        ///< Its air.
  /// The line of the canal of the inferior alveolar nerve, from the mandibular to the mental
  /// foramen.
  /// \param side  -1: right, 1: left.
  [[nodiscard]] std::vector<Vec3> canal_L(double side) const;
  /// Maps the lower teeth of the scan to occlusion.
  [[nodiscard]] RigidTransform X_occlusion_L() const { return X_LH_ * X_jaw_H_.inverse() * X_HL_; }
  /// Maps a point of a tooth to the scan.
  [[nodiscard]] Vec3 from_tooth_L(const ToothForm& tooth, const Vec3& p_M) const;

 private:
  /// A point of the frame of the head in the mandible of the mean head.
  [[nodiscard]] Vec3 in_jaw(const Vec3& p_H) const;
  [[nodiscard]] Vec3 in_dentition(const Vec3& p_H) const;
  /// The maxilla with the sockets of its teeth.
  [[nodiscard]] double alveolar(double maxilla, const Vec3& p_L) const;

  HeadShape shape_;
  RigidTransform X_LH_, X_HL_;
  /// With teeth: the body of the mandible from occlusion, the opening, and both; in frame H.
  RigidTransform X_body_H_, X_opening_H_, X_jaw_H_;
  std::shared_ptr<const Dentition> teeth_;
};

/// The opening of the mandible [rad] at which the smallest distance of upper and lower teeth is
/// `clearance_mm`.
/// \param shape         with teeth; its opening is ignored.
/// \param clearance_mm  before the scale.
[[nodiscard]] double opening_with_clearance(const HeadShape& shape, double clearance_mm);

struct NamedPoint {
  std::string name;
  Vec3 point_L;
};

/// The true landmarks, computed on the level-set functions in the frame of the true mid-sagittal
/// plane and Frankfurt horizontal. Most are the surface point furthest in the direction, or from
/// the chord, that defines them, found by steepest ascent. Po, En, Ex, Stm and Me' are the first
/// surface points on a line; Ch is the end of the slit between the lips; PNS and Al are points from
/// which the head is made.
[[nodiscard]] std::vector<NamedPoint> true_landmarks(const ParametricHead& head);

/// A scan of the head with noise, and its true labels. Partial volume follows the distance to the
/// surfaces; only bone, mandible, soft tissue, background and, with teeth, the pharynx are labeled.
///
/// Without teeth bone has 1000 HU everywhere. With teeth there are enamel (2500 HU), dentin (1500
/// HU), marrow below cortical bone of the jaws, canals of the nerves, and air in the pharynx.
///
/// \param voxel_mm  edge of the cubic voxels.
/// \param noise_hu  standard deviation.
[[nodiscard]] LabeledScan scan_of(const ParametricHead& head, double voxel_mm, double noise_hu,
                                  std::uint64_t seed);

/// The same of a box in the frame of the scan, without the rotation of the head.
[[nodiscard]] LabeledScan scan_of(const ParametricHead& head, const Box3& box_L, double voxel_mm,
                                  double noise_hu, std::uint64_t seed);

}  // namespace lefort::anatomy
