/// \file
/// Anatomical directions of a head, and movements in the terms of a surgeon.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/plan/landmarks.h>

#include <span>

namespace lefort::plan {

/// Three perpendicular unit vectors.
struct HeadDirections {
  Vec3 left_L = Vec3::UnitX();
  Vec3 anterior_L = -Vec3::UnitY();
  Vec3 superior_L = Vec3::UnitZ();
  bool has_frankfurt_horizontal = false;  ///< Otherwise the head is as upright as in the scan.
};

/// Left is patient_left_axis(); anterior is the direction from porion to orbitale, normal to left,
/// or else that of the scan.
///
/// \param landmarks  of one head; may be empty.
/// \returns the directions; or the error of patient_left_axis(); or kPlanInvalid if orbitale and
///   porion are less than 20 mm from each other in the lateral view, or the direction to orbitale
///   differs by more than 60 degrees from anterior in the scan: they may be exchanged.
[[nodiscard]] Result<HeadDirections> head_directions(std::span<const Landmark> landmarks);

/// A rigid motion as surgeons describe it.
struct MovementTerms {
  double anterior_mm = 0.0;  ///< Advancement; negative: setback.
  double left_mm = 0.0;      ///< To the patient's left.
  double superior_mm = 0.0;  ///< Impaction of the maxilla; negative: to inferior.
  double yaw_deg = 0.0;      ///< Anterior parts to the patient's left.
  double pitch_deg = 0.0;    ///< Anterior parts to inferior.
  double roll_deg = 0.0;     ///< The patient's left side to superior.
};

/// Translation of a point, and the rotation as yaw about superior, then pitch about the turned left
/// axis, then roll about the turned anterior axis (Tait-Bryan angles).
///
/// \param X_LB        the motion.
/// \param at_L        the point before the motion.
/// \param directions  of the head.
[[nodiscard]] MovementTerms movement_terms(const RigidTransform& X_LB, const Vec3& at_L,
                                           const HeadDirections& directions);

}  // namespace lefort::plan
