/// \file
/// Procedure and direction of the movement of each segment of a plan.
#pragma once

#include <lefort/compare/published_ratios.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/landmarks.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace lefort::compare {

/// The procedure of each segment: by the template of its osteotomy; without one, by the landmarks
/// on it, in this order: Zy, FZ: Le Fort III; Or, N: Le Fort II; ANS, A, U1: Le Fort I; L1, B:
/// sagittal split; Pg, Gn, Me: genioplasty; without these, that of the segment it was cut from. A
/// Le Fort II or III by distraction is a midface distraction. The whole mandible is compared with
/// sagittal splits, which move the chin, too.
///
/// \param planned    the segments.
/// \param landmarks  before surgery.
/// \param bones      of the landmarks (plan::bones_of_landmarks()).
/// \returns one entry per segment; kUnknown if no rule applies.
[[nodiscard]] std::vector<Procedure> procedures_of(
    std::span<const plan::PlannedSegment> planned, std::span<const plan::Landmark> landmarks,
    std::span<const std::optional<std::size_t>> bones);

/// \param axis         of the movement.
/// \param movement_mm  positive to anterior, superior, left.
/// \returns the direction; kLateral for the lateral axis.
[[nodiscard]] Direction direction_of(FaceAxis axis, double movement_mm);

}  // namespace lefort::compare
