#include <lefort/compare/procedures.h>

#include <string_view>
#include <utility>

namespace lefort::compare {
namespace {

Procedure procedure_of(plan::OsteotomyTemplate kind) {
  switch (kind) {
    case plan::OsteotomyTemplate::kLeFort1:
      return Procedure::kLeFort1;
    case plan::OsteotomyTemplate::kLeFort2:
      return Procedure::kLeFort2;
    case plan::OsteotomyTemplate::kLeFort3:
      return Procedure::kLeFort3;
    case plan::OsteotomyTemplate::kGenioplasty:
      return Procedure::kGenioplasty;
    case plan::OsteotomyTemplate::kSagittalSplit:
      return Procedure::kSagittalSplit;
  }
  return Procedure::kUnknown;
}

/// The first of these landmarks on a segment shows its procedure.
constexpr std::pair<std::string_view, Procedure> kMarks[] = {
    {"Zy-R", Procedure::kLeFort3},     {"Zy-L", Procedure::kLeFort3},
    {"FZ-R", Procedure::kLeFort3},     {"FZ-L", Procedure::kLeFort3},
    {"Or-R", Procedure::kLeFort2},     {"Or-L", Procedure::kLeFort2},
    {"N", Procedure::kLeFort2},        {"ANS", Procedure::kLeFort1},
    {"A", Procedure::kLeFort1},        {"U1", Procedure::kLeFort1},
    {"L1", Procedure::kSagittalSplit}, {"B", Procedure::kSagittalSplit},
    {"Pg", Procedure::kGenioplasty},   {"Gn", Procedure::kGenioplasty},
    {"Me", Procedure::kGenioplasty}};

/// By the landmarks on a segment.
Procedure procedure_by_landmarks(std::size_t segment, std::span<const plan::Landmark> landmarks,
                                 std::span<const std::optional<std::size_t>> bones) {
  for (const auto& [name, procedure] : kMarks)
    for (std::size_t n = 0; n < landmarks.size(); ++n)
      if (bones[n] == segment && landmarks[n].name == name) return procedure;
  return Procedure::kUnknown;
}

}  // namespace

std::vector<Procedure> procedures_of(std::span<const plan::PlannedSegment> planned,
                                     std::span<const plan::Landmark> landmarks,
                                     std::span<const std::optional<std::size_t>> bones) {
  std::vector<Procedure> procedures;
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const auto& planned_as = planned[k].osteotomy.procedure;
    Procedure procedure =
        planned_as ? procedure_of(*planned_as) : procedure_by_landmarks(k, landmarks, bones);
    if (planned[k].is_whole_mandible) procedure = Procedure::kSagittalSplit;
    for (std::size_t parent = 0; parent < k && procedure == Procedure::kUnknown; ++parent)
      if (planned[parent].osteotomy.segment == planned[k].cut_from) procedure = procedures[parent];
    if (planned[k].is_distracted &&
        (procedure == Procedure::kLeFort2 || procedure == Procedure::kLeFort3))
      procedure = Procedure::kMidfaceDistraction;
    procedures.push_back(procedure);
  }
  return procedures;
}

Direction direction_of(FaceAxis axis, double movement_mm) {
  if (axis == FaceAxis::kAnterior)
    return movement_mm > 0.0 ? Direction::kAdvancement : Direction::kSetback;
  if (axis == FaceAxis::kSuperior)
    return movement_mm > 0.0 ? Direction::kImpaction : Direction::kLowering;
  return Direction::kLateral;
}

}  // namespace lefort::compare
