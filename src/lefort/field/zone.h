/// \file
/// Zone of a point relative to the narrow band of a surface.
#pragma once

#include <cstdint>

namespace lefort::field {

/// Where a point lies relative to the band.
enum class Zone : std::uint8_t {
  kBand,     ///< In the band.
  kOutside,  ///< Beyond the band, outside the surface.
  kInside,   ///< Beyond the band, inside the surface.
  /// Beyond the band of an open surface, or signs are in conflict, or the point is not finite.
  kUnknown
};

}  // namespace lefort::field
