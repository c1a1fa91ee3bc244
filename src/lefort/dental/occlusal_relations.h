/// \file
/// Midlines and relations of canines and molars of two arches whose teeth are numbered.
#pragma once

#include <lefort/core/types.h>
#include <lefort/dental/measure_occlusion.h>

#include <map>
#include <optional>
#include <string_view>

namespace lefort::dental {

/// The crown of a tooth.
struct Crown {
  Vec3 center_L = Vec3::Zero();
  double width_mm = 0.0;  ///< Along the arch; NaN: unknown.
};
using NumberedCrowns = std::map<int, Crown>;  ///< By FDI number.

/// Relations of the arches [mm]; NaN where a tooth is missing.
struct OcclusalRelations {
  double midline_mm;  ///< Lower dental midline from the upper one, to the patient's left.
  /// Of the lower tooth from class I, along the lower arch: positive to mesial (class III),
  /// negative to distal (class II).
  double right_canine_mm, left_canine_mm, right_molar_mm, left_molar_mm;
};

/// Angle's class of a relation: I up to half of half a premolar (1.75 mm), then II or III; empty if
/// the relation is NaN.
[[nodiscard]] std::string_view angle_class(double relation_mm);

/// The middle between the crowns of the central incisors.
///
/// \param is_upper  of teeth 11 and 21, otherwise of 31 and 41.
/// \returns nothing if one of both is missing.
[[nodiscard]] std::optional<Vec3> dental_midline(const NumberedCrowns& crowns_L, bool is_upper);

/// Relations by the classes of Angle 1899 \cite angle1899. Class I of canines: the upper canine
/// is opposite the distal end of the lower one. Class I of first molars: the mesiobuccal cusp of
/// the upper one, a quarter of its width mesial of its center, is opposite the buccal groove of the
/// lower one, a tenth of its width mesial of its center (\cite nelson2010). Mesial is the
/// direction to the nearest tooth in front, that of a canine from the nearest tooth behind.
///
/// \param crowns_L   of both jaws, in the frame of the CT.
/// \param X_L_lower  movement of the lower arch from the CT.
/// \param axes       of the arches.
[[nodiscard]] OcclusalRelations occlusal_relations(const NumberedCrowns& crowns_L,
                                                   const RigidTransform& X_L_lower,
                                                   const ArchAxes& axes);

}  // namespace lefort::dental
