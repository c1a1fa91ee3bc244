/// \file
/// How solving a linear system may end.
#pragma once

#include <cstdint>

namespace lefort::linear {

/// What came of a factorization or a solution.
enum class LinearSolveStatus : std::uint8_t {
  kDone,
  kNotPositiveDefinite,  ///< A pivot was not positive, or a direction of negative energy was met.
  kNotFinite,            ///< The matrix holds NaN or infinity.
  kOutOfMemory,          ///< The factor does not fit into memory.
  kNotConverged          ///< The iterations were too many.
};

}  // namespace lefort::linear
