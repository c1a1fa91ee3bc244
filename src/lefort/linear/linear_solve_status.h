/// \file
/// Status of a linear solve.
#pragma once

#include <cstdint>

namespace lefort::linear {

/// Why a factorization or a solve ended.
enum class LinearSolveStatus : std::uint8_t {
  kDone,
  kNotPositiveDefinite,  ///< A pivot or a curvature is not positive, or A is nearly singular.
  kNotFinite,            ///< The matrix contains NaN or infinity.
  kOutOfMemory,          ///< The factor exceeds the memory or its limit.
  kNotConverged          ///< The maximum number of iterations was reached.
};

}  // namespace lefort::linear
