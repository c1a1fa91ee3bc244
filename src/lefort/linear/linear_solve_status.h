/// \file
/// Status of a linear solve.
#pragma once

#include <cstdint>

namespace lefort::linear {

/// Why a factorization or a solve ended.
enum class LinearSolveStatus : std::uint8_t {
  kDone,
  kNotPositiveDefinite,  ///< A pivot or a curvature was not positive.
  kNotFinite,            ///< The matrix contains NaN or infinity.
  kOutOfMemory,          ///< The factor does not fit into memory.
  kNotConverged          ///< The maximum number of iterations was reached.
};

}  // namespace lefort::linear
