/// \file
/// Zone of a point relative to the narrow band of a surface.
#pragma once

#include <cstdint>

namespace lefort::field {

/// In the band, or outside it; kUnknown where an open surface does not determine the sign.
enum class Zone : std::uint8_t { kBand, kOutside, kInside, kUnknown };

}  // namespace lefort::field
