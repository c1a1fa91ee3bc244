/// \file
/// Finds the weakest mode of a body.
#pragma once

#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/assemble.h>

#include <cstdint>
#include <optional>

namespace lefort::solve {

/// The displacement with the smallest stiffness.
struct WeakestMode {
  bool resists = true;            ///< False if the tangent is not positive definite.
  std::int32_t node = 0;          ///< With the largest displacement.
  Vec3 direction = Vec3::Zero();  ///< Of that node; unit length.
};

/// Finds the mode by inverse iteration with the tangent, which is shifted until it is positive
/// definite.
///
/// \param assembler  of the body.
/// \param u          displacements of all components, admissible.
/// \param progress   may stop the search before each factorization.
/// \returns the mode; nothing if the tangent is not finite or does not fit into memory, or if
///   `progress` requested a stop.
/// \note Cost: a few direct factorizations. Deterministic: the start vector is fixed.
[[nodiscard]] std::optional<WeakestMode> find_weakest_mode(const fem::Assembler& assembler,
                                                           const VectorX& u,
                                                           Progress& progress = Progress::none());

}  // namespace lefort::solve
