/// \file
/// Colors of segments in pictures.
#pragma once

#include <lefort/report/render_surfaces.h>

#include <array>

namespace lefort::report {

/// Okabe and Ito's colors, which color-blind readers can distinguish.
inline constexpr std::array<Rgb, 6> kSegmentColors{{{0.34, 0.71, 0.91},
                                                    {0.90, 0.62, 0.00},
                                                    {0.00, 0.62, 0.45},
                                                    {0.80, 0.47, 0.65},
                                                    {0.94, 0.89, 0.26},
                                                    {0.84, 0.37, 0.00}}};

}  // namespace lefort::report
