/// \file
/// Where a body gives way first.
#pragma once

#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/assemble.h>

#include <cstdint>
#include <optional>

namespace lefort::solve {

/// The motion that the body resists least.
struct WeakestMode {
  bool resists = true;            ///< False if the tangent is not positive definite.
  std::int32_t node = 0;          ///< Moves most.
  Vec3 direction = Vec3::Zero();  ///< Of that node; unit length.
};

/// \param u  displacements of all components, admissible.
/// \param progress  asked before every factorization whether to stop.
/// \returns the motion; nothing if the tangent is not finite or does not fit into memory, or if
///   `progress` asked to stop.
/// \note Cost: a few direct factorizations. By inverse iteration from a fixed start, so always the
///   same.
[[nodiscard]] std::optional<WeakestMode> find_weakest_mode(const fem::Assembler& assembler,
                                                           const VectorX& u,
                                                           Progress& progress = Progress::none());

}  // namespace lefort::solve
