/// \file
/// Finds the weakest mode of a body.
#pragma once

#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/assemble.h>

#include <cstdint>
#include <optional>

namespace lefort::solve {

/// Eigenvector of the tangent with the smallest eigenvalue.
struct WeakestMode {
  bool resists = true;            ///< False if the tangent is not positive definite.
  std::int32_t node = 0;          ///< Node with the largest displacement in the mode.
  Vec3 direction = Vec3::Zero();  ///< Direction of the displacement of `node`; unit length.
};

/// Finds the mode by inverse iteration with the tangent, to whose diagonal a growing shift is added
/// until it is positive definite.
///
/// \param assembler  of the body.
/// \param u          displacements of all components [mm].
/// \param progress   may stop the search before each factorization.
/// \returns the mode; nothing if no component is free, u is inadmissible, the factorization fails
///   (the tangent is not finite, its factor does not fit into memory, or it is indefinite even with
///   the largest shift), or `progress` requested a stop.
/// \note Cost: one direct factorization if the tangent is positive definite, else one more for each
///   shift, at most 14. Deterministic: the start vector is fixed.
[[nodiscard]] std::optional<WeakestMode> find_weakest_mode(const fem::Assembler& assembler,
                                                           const VectorX& u,
                                                           Progress& progress = Progress::none());

}  // namespace lefort::solve
