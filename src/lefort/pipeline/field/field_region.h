/// \file
/// A box from command-line options.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <fmt/format.h>

#include <optional>
#include <span>

namespace lefort::pipeline {

/// \param limits_mm  empty, or from and to along x, y and z.
/// \returns the box, if there are limits; kInvalidArgument if a limit is missing, or a lower limit
///   exceeds the upper one.
[[nodiscard]] inline Result<std::optional<Box3>> region_of(std::span<const double> limits_mm) {
  if (limits_mm.empty()) return std::optional<Box3>();
  if (limits_mm.size() != 6)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("region has {} limits, it must have 6: from and to along x, y and z",
                            limits_mm.size()));
  Box3 box;
  for (int k = 0; k < 3; ++k) {
    box.min()[k] = limits_mm[std::size_t(2 * k)];
    box.max()[k] = limits_mm[std::size_t(2 * k + 1)];
    if (!(box.min()[k] <= box.max()[k]))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("region runs from {} to {} mm along {}, it must run upwards",
                              box.min()[k], box.max()[k], "xyz"[k]));
  }
  return std::optional<Box3>(box);
}

}  // namespace lefort::pipeline
