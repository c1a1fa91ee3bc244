/// \file
/// Published norms of cephalometric measurements.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace lefort::plan {

enum class Sex { kFemale, kMale };

/// Mean and standard deviation of one measurement.
struct NormValue {
  double mean;
  std::optional<double> deviation = std::nullopt;  ///< None: not published.
};

/// The norm of one measurement in one analysis.
struct CephalometricNorm {
  const char* analysis;     ///< "McNamara".
  const char* measurement;  ///< Name of a row of measure().
  NormValue female, male;   ///< Equal if the source does not distinguish.
  const char* source;       ///< Author, year, sample.
};

/// All norms, by analysis. Of Caucasian samples without deformity; other populations differ.
///
/// Lengths of McNamara are divided by 1.08, the enlargement of his films. Those of Ricketts are his
/// values of 1981 at the age of 18. Norms of Steiner have no deviation. The figures of Arnett and
/// McNamara (A-Nperp, Pg-Nperp, FH-MP) are from memory: their sources say "not verified". Downs and
/// Ricketts measure the mandibular plane at the tangent of the lower border, not at Go-Me.
[[nodiscard]] std::span<const CephalometricNorm> cephalometric_norms();

/// How far a value lies from its norm, in standard deviations; nothing without a deviation.
[[nodiscard]] std::optional<double> deviation_from(const CephalometricNorm& norm, Sex sex,
                                                   double value);

}  // namespace lefort::plan
