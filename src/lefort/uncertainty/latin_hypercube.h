/// \file
/// Latin hypercube designs that can be extended.
#pragma once

#include <lefort/core/types.h>

#include <cstdint>

namespace lefort::uncertainty {

/// Points of the first design. Each later one has twice as many.
inline constexpr Index kFirstDesign = 25;

/// Points of a Latin hypercube \cite mckay1979 that is doubled until it has enough of them
/// (\cite sallaberry2008). The first 25, 50, 100, 200, ... points are Latin hypercubes, with one
/// point in each of 25, 50, ... strata of every input. Fewer points are the first ones of more.
///
/// \param inputs  number of columns, >= 1.
/// \param count   number of rows, >= 1.
/// \param seed    the same seed gives the same bits.
/// \returns probabilities in (0, 1), one row per point.
[[nodiscard]] Eigen::MatrixXd nested_latin_hypercube(Index inputs, Index count, std::uint64_t seed);

}  // namespace lefort::uncertainty
