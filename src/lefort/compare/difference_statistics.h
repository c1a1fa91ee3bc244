/// \file
/// Differences in numbers, as studies of soft-tissue prediction report them.
#pragma once

#include <lefort/compare/surface_difference.h>

#include <functional>

namespace lefort::compare {

/// Over area, so that they do not depend on how finely a surface is cut into triangles. All but
/// `area_mm2` and `compared_fraction` are NaN where nothing is compared.
struct DifferenceStatistics {
  double area_mm2 = 0.0;           ///< Of the part that was asked for.
  double compared_fraction = 0.0;  ///< Of that area, 0 to 1.
  double mean_mm = 0.0;            ///< Of the distance without sign, as all below.
  double median_mm = 0.0;
  double p90_mm = 0.0;
  double p95_mm = 0.0;
  double p99_mm = 0.0;
  double max_mm = 0.0;
  double fraction_below_1mm = 0.0;  ///< Of the compared area, 0 to 1.
  double fraction_below_2mm = 0.0;
  double mean_signed_mm = 0.0;  ///< Positive: outside of the other surface.
};

/// \param is_requested  says which vertices count.
[[nodiscard]] DifferenceStatistics describe(const SurfaceDifference& difference,
                                            const std::function<bool(Index vertex)>& is_requested);

}  // namespace lefort::compare
