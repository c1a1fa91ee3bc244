/// \file
/// The oral vestibule: the space between teeth and gingiva on one side, lips and cheeks on the
/// other. In a closed mouth it shows no air. Described in docs/theory/interface.md.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/types.h>
#include <lefort/predict/jaw_teeth.h>

#include <optional>

namespace lefort::predict {

/// Height of the crowns of the incisors, from the gingival margin to the incisal edge
/// (\cite magne2003, \cite nelson2015).
inline constexpr double kUpperCrown_mm = 10.5, kLowerCrown_mm = 9.0;

/// Where tissue on a jaw is not attached: within the height of the crowns and the depth of the
/// vestibule from the edges of the teeth. Lingual of the teeth, the same depth is used. In the part
/// of the arch of a known tooth, the depth begins at its cemento-enamel junction.
struct OralVestibule {
  Vec3 normal_L = Vec3::UnitZ();  ///< Of the occlusal plane, unit vector, to superior.
  Vec3 front_L = Vec3::Zero();    ///< Anterior surface of the teeth in the middle.
  double upper_fold_mm = 0.0;     ///< normal . p at the fold of the upper jaw.
  double upper_edge_mm = 0.0;     ///< normal . p at the edge of the upper jaw.
  double lower_edge_mm = 0.0;     ///< normal . p at the edge of the lower jaw.
  double lower_fold_mm = 0.0;     ///< normal . p at the fold of the lower jaw.

  double depth_mm = 0.0;            ///< From the gingival margin to the fold.
  const JawTeeth* teeth = nullptr;  ///< May be null.

  /// \param p_L          a point on a jaw.
  /// \param on_mandible  or on the upper jaw.
  [[nodiscard]] bool contains(const Vec3& p_L, bool on_mandible) const;
};

/// The occlusal plane is the least-squares plane midway between the facing edges of both jaws.
///
/// \param labels    of the scan.
/// \param depth_mm  from the gingival margin to the fold, >= 0; in 100 mandibles 2.5 to 11.5 mm
///   (\cite ward1976).
/// \param teeth     may be null; must outlive the vestibule.
/// \returns nothing if find_jaw_edges() finds none.
[[nodiscard]] std::optional<OralVestibule> find_oral_vestibule(const anatomy::LabelMap& labels,
                                                               double depth_mm,
                                                               const JawTeeth* teeth = nullptr);

}  // namespace lefort::predict
