/// \file
/// Anatomical points by name: what surgeons measure between, turn about and aim at. A value.
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
  std::string name;  ///< "A", "Or-R"; any other name is one, too.
  Vec3 point_L;      ///< [mm].
};

using Landmarks = std::vector<Landmark>;

/// One of the field's landmarks (docs/guide/landmarks.md).
struct LandmarkKind {
  const char* abbreviation;  ///< Without the side: "Or".
  const char* name;          ///< "orbitale".
  bool is_soft;              ///< On the skin; else on bone or teeth.
  bool is_paired;            ///< Then its landmarks end in "-R" and "-L", the patient's sides.
};

/// All of them, bone first.
[[nodiscard]] std::span<const LandmarkKind> landmark_kinds();

/// The kind that "Or-R" is of; null for a name that is none of the field's, and for a pair without
/// a side.
[[nodiscard]] const LandmarkKind* landmark_definition(std::string_view name);

/// "right orbitale" for "Or-R", the name itself if it is none of the field's.
[[nodiscard]] std::string full_name(std::string_view name);

/// Where the landmark of that name is, if it is there.
[[nodiscard]] std::optional<Vec3> find_landmark(std::span<const Landmark> landmarks,
                                                std::string_view name);

/// The middle between the two of a pair; the one that is there if the other is not, or what has the
/// name without a side.
[[nodiscard]] std::optional<Vec3> pair_midpoint(std::span<const Landmark> landmarks,
                                                std::string_view name);

/// Towards the patient's left, unit length: the mean direction of the field's pairs from right to
/// left, or x if there is no pair.
///
/// Sides exchanged by mistake would turn a head over, so what names say about them is held against
/// L, whose x runs to the patient's left.
///
/// \returns kPlanInvalid, which names the landmarks, if
///   - a pair runs more than 60 degrees off the patient's left, or off the mean of all pairs;
///   - there are pairs, and a landmark that has a side lies more than 5 mm beyond the mid-plane,
///     which goes through the mean of the pairs' middles and of the field's landmarks without a
///     side.
[[nodiscard]] Result<Vec3> patient_left_axis(std::span<const Landmark> landmarks);

/// The first name that stands twice, if one does.
[[nodiscard]] std::optional<std::string> first_repeated_name(std::span<const Landmark> landmarks);

}  // namespace lefort::plan
