/// \file
/// The classic osteotomies, placed by landmarks. What each cuts is drawn in docs/guide/osteotomies.md.
///
/// They are made of planes, so they follow the surgeon's lines only as far as planes do: a start to
/// be looked at, not a cutting guide.
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

enum class OsteotomyTemplate {
  kLeFort1,        ///< The maxilla below the nose: ANS, PNS.
  kLeFort2,        ///< The pyramid of maxilla and nose: N, Or-R, Or-L, ANS, PNS.
  kLeFort3,        ///< The mid-face with the zygomas: N, Or, FZ on both sides, ANS, PNS.
  kGenioplasty,    ///< The chin: Me, Pg, Go on both sides.
  kSagittalSplit,  ///< The tooth-bearing mandible (BSSO): Me, and Go, Co, L6 on both sides.
};

/// "le-fort-1", "le-fort-2", "le-fort-3", "genioplasty", "sagittal-split".
[[nodiscard]] std::string_view name_of(OsteotomyTemplate kind);
[[nodiscard]] std::optional<OsteotomyTemplate> find_template(std::string_view name);

/// How far from the landmarks the planes lie.
struct TemplateOptions {
  double above_palate_mm =
      5.0;  ///< Le Fort I: above ANS, along the palate; roots of teeth end below.
  double behind_palate_mm = 0.0;  ///< Le Fort I to III: of PNS, where maxilla and pterygoid part.
  double behind_rim_mm =
      12.0;  ///< Le Fort III: of FZ, through the orbit's lateral wall and the arch.
  double above_pogonion_mm = 6.0;  ///< Genioplasty.
  double split_depth_mm = 5.0;     ///< Sagittal split: of the sagittal plane inside Go.
  double behind_molar_mm = 12.0;   ///< Sagittal split: of L6, where the buccal cut is.
};

/// The osteotomy of that kind. Its frame is the patient's: left from the pairs of landmarks, the
/// palate, and the Frankfurt horizontal where it is known.
///
/// \param landmarks  at least those the kind names above.
/// \returns kPlanInvalid that names the first landmark missing, or two that lie in one point,
///   or those whose sides or order contradict L (see patient_left_axis()).
[[nodiscard]] Result<Osteotomy> make_osteotomy(OsteotomyTemplate kind, const std::string& segment,
                                               std::span<const Landmark> landmarks,
                                               const TemplateOptions& options = {});

}  // namespace lefort::plan
