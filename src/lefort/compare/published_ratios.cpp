#include <lefort/compare/published_ratios.h>

#include <algorithm>
#include <cmath>

namespace lefort::compare {

const char* name_of(Procedure procedure) {
  switch (procedure) {
    case Procedure::kUnknown:
      return "unknown";
    case Procedure::kLeFort1:
      return "le-fort-1";
    case Procedure::kLeFort2:
      return "le-fort-2";
    case Procedure::kLeFort3:
      return "le-fort-3";
    case Procedure::kSagittalSplit:
      return "sagittal-split";
    case Procedure::kGenioplasty:
      return "genioplasty";
    case Procedure::kExpansion:
      return "expansion";
    case Procedure::kMidfaceDistraction:
      return "midface-distraction";
    case Procedure::kBimaxillary:
      return "bimaxillary";
  }
  return "";
}

const char* title_of(Procedure procedure) {
  switch (procedure) {
    case Procedure::kUnknown:
      return "unknown procedure";
    case Procedure::kLeFort1:
      return "Le Fort I";
    case Procedure::kLeFort2:
      return "Le Fort II";
    case Procedure::kLeFort3:
      return "Le Fort III";
    case Procedure::kSagittalSplit:
      return "sagittal split";
    case Procedure::kGenioplasty:
      return "genioplasty";
    case Procedure::kExpansion:
      return "maxillary expansion";
    case Procedure::kMidfaceDistraction:
      return "midface distraction";
    case Procedure::kBimaxillary:
      return "bimaxillary";
  }
  return "";
}

const char* name_of(FaceAxis axis) {
  switch (axis) {
    case FaceAxis::kAnterior:
      return "anterior";
    case FaceAxis::kSuperior:
      return "superior";
    case FaceAxis::kLateral:
      return "lateral";
  }
  return "";
}

const char* name_of(Direction direction) {
  switch (direction) {
    case Direction::kAdvancement:
      return "advancement";
    case Direction::kSetback:
      return "setback";
    case Direction::kImpaction:
      return "impaction";
    case Direction::kLowering:
      return "lowering";
    case Direction::kWidening:
      return "widening";
    case Direction::kLateral:
      return "lateral";
    case Direction::kAny:
      return "any";
  }
  return "";
}

bool PublishedRange::contains(double ratio) const {
  if (!(low < high)) return std::abs(ratio - low) <= kMeanTolerance;
  return low <= ratio && ratio <= high;
}

std::optional<PublishedRange> range_of(std::span<const PublishedRatio> rows) {
  if (rows.empty()) return std::nullopt;
  PublishedRange range{rows.front().low, rows.front().high, {}, false};
  for (const PublishedRatio& row : rows) {
    range.low = std::min(range.low, row.low);
    range.high = std::max(range.high, row.high);
    range.is_recalled |= row.is_recalled;
    if (std::find(range.sources.begin(), range.sources.end(), row.source) == range.sources.end())
      range.sources.push_back(row.source);
  }
  return range;
}

}  // namespace lefort::compare
