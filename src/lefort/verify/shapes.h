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

/// Order of the displacement in the L2 norm with mean dilatation: p + 1 if the pressure has at
/// least degree p - 1. The volume change of tet10 and wedge15 is a mean over the element
/// (fem/locking/volumetric_integration.h) and their pressure a constant, which costs one order
/// (\cite boffi2013).
[[nodiscard]] constexpr double averaged_order(mesh::ElementShape shape) {
  return shape == mesh::ElementShape::kHex20 ? 3.0 : 2.0;
}

[[nodiscard]] inline std::string text_of(mesh::ElementShape shape) {
  return std::string(mesh::name_of(shape));
}

}  // namespace lefort::verify
