/// \file
/// Landmarks: named anatomical points for measurements, templates, rotation centers and targets.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::plan {

/// A named point of the patient.
struct Landmark {
  std::string name;  ///< "A", "Or-R"; or any other name.
  Vec3 point_L;      ///< [mm].
};

using Landmarks = std::vector<Landmark>;

/// Definition of a standard landmark (docs/guide/landmarks.md).
struct LandmarkKind {
  const char* abbreviation;  ///< Without the side: "Or".
  const char* name;          ///< "orbitale".
  bool is_soft;              ///< On the skin; otherwise on bone or teeth.
  bool is_paired;            ///< The names end in "-R" and "-L", the patient's sides.
};

/// \returns all standard landmarks, those of bone and teeth first.
[[nodiscard]] std::span<const LandmarkKind> landmark_kinds();

/// \param name  with the side: "Or-R".
/// \returns the definition; null if the name is not a standard one, or lacks the side of a pair.
[[nodiscard]] const LandmarkKind* landmark_definition(std::string_view name);

/// \param name  with the side.
/// \returns "right orbitale" for "Or-R"; the name itself if it is not a standard one.
[[nodiscard]] std::string full_name(std::string_view name);

/// \param landmarks  to be searched.
/// \param name       with the side.
/// \returns the position of the landmark with that name [mm], nothing if there is none.
[[nodiscard]] std::optional<Vec3> find_landmark(std::span<const Landmark> landmarks,
                                                std::string_view name);

/// \param landmarks  to be searched.
/// \param name       without the side: "Or".
/// \returns the landmark of that name; otherwise the midpoint of the pair, or the existing one of
///   the two; nothing if there is none.
[[nodiscard]] std::optional<Vec3> pair_midpoint(std::span<const Landmark> landmarks,
                                                std::string_view name);

/// The axis towards the patient's left: the mean direction of the standard pairs from right to
/// left, or x if there is no pair.
///
/// If right and left were exchanged, this axis would point to the patient's right, and the superior
/// direction, computed from it and the anterior direction, would point to inferior. The sides in
/// the names are therefore compared with the frame L, whose x axis points to the patient's left.
///
/// \param landmarks  of one head.
/// \returns a unit vector; or kPlanInvalid, with the names of the landmarks, if
///   - the direction of a pair differs by more than 60 degrees from the patient's left, or from the
///     mean of all pairs;
///   - there are pairs, and a right or left landmark lies more than 5 mm on the wrong side of the
///     mid-sagittal plane. That plane passes through the mean of the midpoints of pairs and of the
///     unpaired standard landmarks.
[[nodiscard]] Result<Vec3> patient_left_axis(std::span<const Landmark> landmarks);

/// \param landmarks  to be searched.
/// \returns the first name that occurs twice, if there is one.
[[nodiscard]] std::optional<std::string> first_repeated_name(std::span<const Landmark> landmarks);

}  // namespace lefort::plan
