/// \file
/// Linear solver options that simulate exhausted memory.
#pragma once

#include <lefort/linear/linear_solver.h>

namespace lefort::test {

/// No factor fits into this memory.
[[nodiscard]] inline linear::LinearSolverOptions little_memory() { return {.memory_bytes = 64}; }

}  // namespace lefort::test
