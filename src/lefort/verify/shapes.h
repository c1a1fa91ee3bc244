/// \file
/// The element shapes of all cases, and their expected orders.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <string>

namespace lefort::verify {

inline constexpr std::array<mesh::ElementShape, 7> kAllShapes{
    mesh::ElementShape::kTet4,  mesh::ElementShape::kPyramid5, mesh::ElementShape::kWedge6,
    mesh::ElementShape::kHex8,  mesh::ElementShape::kTet10,    mesh::ElementShape::kWedge15,
    mesh::ElementShape::kHex20,
};

/// Degree of the complete polynomials of the displacement: 1 or 2.
[[nodiscard]] constexpr int degree(mesh::ElementShape shape) {
  return shape == mesh::ElementShape::kTet10 || shape == mesh::ElementShape::kWedge15 ||
                 shape == mesh::ElementShape::kHex20
             ? 2
             : 1;
}

/// Whether decoupled laws average J in this shape (fem/locking/volumetric_integration.h). The
/// others lock near nu = 0.5.
[[nodiscard]] constexpr bool averages_volume(mesh::ElementShape shape) {
  return shape == mesh::ElementShape::kHex8 || degree(shape) == 2;
}

/// The shapes for which this is true.
inline constexpr std::array<mesh::ElementShape, 4> kAveragedShapes{
    mesh::ElementShape::kHex8, mesh::ElementShape::kTet10, mesh::ElementShape::kWedge15,
    mesh::ElementShape::kHex20};

/// Order of the displacement in the L2 norm with averaged volume: p + 1, with the degree p of the
/// displacement, because the pressure has degree p - 1 (\cite boffi2013).
[[nodiscard]] constexpr double averaged_order(mesh::ElementShape shape) {
  return degree(shape) + 1.0;
}

[[nodiscard]] inline std::string text_of(mesh::ElementShape shape) {
  return std::string(mesh::name_of(shape));
}

}  // namespace lefort::verify
