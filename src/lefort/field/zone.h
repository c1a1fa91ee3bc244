/// \file
/// Where a point lies relative to the band around a surface.
#pragma once

#include <cstdint>

namespace lefort::field {

/// Within the band, or beyond it; kUnknown where a surface with a hole does not say.
enum class Zone : std::uint8_t { kBand, kOutside, kInside, kUnknown };

}  // namespace lefort::field
