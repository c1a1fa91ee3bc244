/// \file
/// A machine whose memory is used up, for the linear solver alone.
#pragma once

#include <lefort/linear/linear_solver.h>

namespace lefort::test {

/// No factor fits into this.
[[nodiscard]] inline linear::LinearSolverOptions little_memory() { return {.memory_bytes = 64}; }

}  // namespace lefort::test
