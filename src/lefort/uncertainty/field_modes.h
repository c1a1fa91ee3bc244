/// \file
/// Karhunen-Loeve modes of a field that is known in samples.
#pragma once

#include <lefort/core/types.h>

#include <span>
#include <vector>

namespace lefort::uncertainty {

/// A field as its mean and modes: value = mean + modes * scores. Modes are orthonormal with the
/// weights of the points, ordered by their variance.
struct FieldModes {
  VectorX mean;            ///< One per point.
  Eigen::MatrixXd modes;   ///< Points by modes.
  Eigen::MatrixXd scores;  ///< Samples by modes.
  double kept = 1.0;       ///< Fraction of the variance in the modes.
  double rms_error = 0.0;  ///< Of the samples without the other modes; weighted over points.
  double max_error = 0.0;  ///< Largest over samples and points.
};

/// Principal components by the method of snapshots \cite sirovich1987.
///
/// \param samples   one field each, of equal length; one or more. Floats, because there are many.
/// \param weights   of the points, >= 0, not all 0.
/// \param fraction  of the variance that the modes must contain, 0 to 1.
/// \returns the fewest modes that contain this fraction; none if all samples are equal.
[[nodiscard]] FieldModes find_modes(std::span<const std::vector<float>> samples,
                                    std::span<const double> weights, double fraction);

}  // namespace lefort::uncertainty
