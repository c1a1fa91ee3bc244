/// \file
/// Statistics of surface differences, as reported by studies of soft-tissue prediction.
#pragma once

#include <lefort/compare/surface_difference.h>

#include <functional>

namespace lefort::compare {

/// Statistics weighted by area, so that they do not depend on the triangulation. All except
/// `area_mm2` and `compared_fraction` are NaN if nothing is compared.
struct DifferenceStatistics {
  double area_mm2 = 0.0;           ///< Of the requested part.
  double compared_fraction = 0.0;  ///< Of that area, 0 to 1.
  double mean_mm = 0.0;            ///< Of the absolute distance, as the next seven.
  double median_mm = 0.0;
  double p90_mm = 0.0;
  double p95_mm = 0.0;
  double p99_mm = 0.0;
  double max_mm = 0.0;
  double fraction_below_1mm = 0.0;  ///< Of the compared area, 0 to 1.
  double fraction_below_2mm = 0.0;
  double mean_signed_mm = 0.0;  ///< Positive: outside the other surface.
};

/// \param difference    of a surface.
/// \param is_requested  whether a vertex belongs to the part.
/// \returns the statistics of the part.
[[nodiscard]] DifferenceStatistics describe(const SurfaceDifference& difference,
                                            const std::function<bool(Index vertex)>& is_requested);

}  // namespace lefort::compare
