/// \file
/// Published ratios of the movement of soft tissue to that of bone, by procedure and landmark.
///
/// The table is data/soft_tissue_ratios.csv, which cmake/embed_soft_tissue_ratios.py checks and
/// compiles into the program. docs/reference/soft-tissue-ratios.md describes it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace lefort::compare {

enum class Procedure : std::uint8_t {
  kUnknown,  ///< No template, and no landmark that identifies the segment.
  kLeFort1,
  kLeFort2,
  kLeFort3,
  kSagittalSplit,  ///< Bilateral sagittal split osteotomy (BSSO): the distal segment.
  kGenioplasty,
  kExpansion,           ///< Parts of the maxilla that move apart.
  kMidfaceDistraction,  ///< Le Fort II or III by distraction.
  kBimaxillary,         ///< Only in the table: studies of maxilla and mandible moved together.
};

/// \param procedure  a procedure.
/// \returns the name in files: "le-fort-1", "sagittal-split", ..., "unknown"; title_of(): the name
///   in texts, "Le Fort I", ...
[[nodiscard]] const char* name_of(Procedure procedure);
[[nodiscard]] const char* title_of(Procedure procedure);

/// Axes of the face: to anterior, superior, and the patient's left.
enum class FaceAxis : std::uint8_t { kAnterior, kSuperior, kLateral };

/// \param axis  an axis.
/// \returns "anterior", "superior" or "lateral".
[[nodiscard]] const char* name_of(FaceAxis axis);

/// Movement along an axis.
enum class Direction : std::uint8_t {
  kAdvancement,  ///< To anterior.
  kSetback,      ///< To posterior.
  kImpaction,    ///< To superior.
  kLowering,     ///< To inferior.
  kWidening,     ///< Lateral, away from another part of the maxilla.
  kLateral,      ///< Lateral, otherwise.
  kAny,          ///< Only in the table: a study that combines directions.
};

/// \param direction  a direction.
/// \returns "advancement", "setback", "impaction", "lowering", "widening", "lateral" or "any".
[[nodiscard]] const char* name_of(Direction direction);

/// One row of the table: the ratio of the components along an axis.
struct PublishedRatio {
  Procedure procedure;
  Direction direction;
  FaceAxis axis;
  std::string_view soft;    ///< Landmark of the skin, without side.
  std::string_view hard;    ///< Landmark of bone; or kSegment: movement of the segment as a whole.
  double low, high;         ///< low <= high; equal if the study gives a mean only.
  std::string_view source;  ///< Key of docs/references.bib.
  bool is_recalled;         ///< The value was not compared with the article.
};

inline constexpr std::string_view kSegment = "segment";
/// Shortening of the upper lip: displacement of Stm relative to Sn, along the superior axis only.
inline constexpr std::string_view kUpperLip = "Stm-Sn";

/// A study or review.
struct RatioSource {
  std::string_view key;        ///< Of docs/references.bib.
  std::string_view label;      ///< "Rosen 1988".
  std::string_view reference;  ///< Authors, title, journal.
};

/// \returns all rows, in the order of the file.
[[nodiscard]] std::span<const PublishedRatio> published_ratios();
/// \returns the sources of all rows, by key.
[[nodiscard]] std::span<const RatioSource> ratio_sources();

/// The rows of the table for one movement, as one range.
struct PublishedRange {
  double low = 0.0, high = 0.0;           ///< From the lowest to the highest ratio of the rows.
  std::vector<std::string_view> sources;  ///< Keys, without repetition, in the order of the table.
  bool is_recalled = false;               ///< Of one row or more.

  /// Half width of the interval that stands for a single published mean (means are reported to one
  /// or two digits, standard deviations between patients are larger).
  static constexpr double kMeanTolerance = 0.10;

  /// \returns whether low <= ratio <= high; if low equals high, whether the ratio is within
  ///   kMeanTolerance of it.
  [[nodiscard]] bool contains(double ratio) const;
};

/// \param rows  of one movement.
/// \returns their range, nothing if there is no row.
[[nodiscard]] std::optional<PublishedRange> range_of(std::span<const PublishedRatio> rows);

}  // namespace lefort::compare
