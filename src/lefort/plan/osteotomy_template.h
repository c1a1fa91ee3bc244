/// \file
/// Standard osteotomies, positioned by landmarks. Described in docs/guide/osteotomies.md.
///
/// They consist of planes, so they only approximate surgical osteotomy lines, and do not consider
/// tooth roots: a starting point for planning, not a cutting guide.
#pragma once

#include <lefort/core/error.h>
#include <lefort/plan/landmarks.h>
#include <lefort/plan/plan.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::plan {

/// \param kind  a template.
/// \returns "le-fort-1", "le-fort-2", "le-fort-3", "genioplasty" or "sagittal-split".
[[nodiscard]] std::string_view name_of(OsteotomyTemplate kind);
/// \param name  as returned by name_of().
/// \returns the template of that name, nothing if there is none.
[[nodiscard]] std::optional<OsteotomyTemplate> find_template(std::string_view name);

/// The canal of an inferior alveolar nerve: a tube.
struct NerveCanal {
  std::vector<Vec3> line_L;
  double radius_mm = 0.0;
};

/// Distances of the planes from the landmarks.
struct TemplateOptions {
  /// Le Fort I: of the plane parallel to the palate, above ANS. Usually above the tooth roots; not
  /// checked.
  double above_palate_mm = 5.0;
  /// Le Fort I to III: of the posterior plane at the pterygomaxillary junction, posterior to PNS.
  double behind_palate_mm = 0.0;
  /// Le Fort III: of the coronal plane through lateral orbital wall and zygomatic arch, posterior
  /// to FZ.
  double behind_rim_mm = 12.0;
  double above_pogonion_mm = 6.0;  ///< Genioplasty: of the anterior start of the cut, above Pg.
  double split_depth_mm = 5.0;     ///< Sagittal split: of the plane of the split, medial to Go.
  double behind_molar_mm = 12.0;   ///< Sagittal split: of the buccal cut, posterior to L6.
  /// Sagittal split: canals that stay in the distal segment, one on each side. The split is then at
  /// most split_depth_mm deep, turned about the vertical through Go by up to 20 degrees if it would
  /// be less than 1 mm deep, and the medial cut at least half-way from Go to Co. None: canals are
  /// not considered.
  std::vector<NerveCanal> canals{};
  double canal_clearance_mm = 2.0;  ///< Between their walls and split or medial cut; 0 to 5.
};

/// Positions an osteotomy. Directions are anatomical: left by the pairs of landmarks, anterior by
/// the palate, the Frankfurt horizontal or the mandible.
///
/// \param kind       which osteotomy.
/// \param segment    name of the segment.
/// \param landmarks  at least those that OsteotomyTemplate lists for the kind.
/// \param options    distances from the landmarks.
/// \returns the osteotomy; or kPlanInvalid if a landmark is missing, two landmarks are less than
///   1 mm apart, the landmarks do not determine the directions, or right and left, or anterior and
///   posterior landmarks are exchanged (see patient_left_axis()); or canals are given, and there is
///   none on one side, or the split would be less than 1 mm deep, or the medial cut less than a
///   fifth of the way from Co to Go.
[[nodiscard]] Result<Osteotomy> make_osteotomy(OsteotomyTemplate kind, const std::string& segment,
                                               std::span<const Landmark> landmarks,
                                               const TemplateOptions& options = {});

}  // namespace lefort::plan
