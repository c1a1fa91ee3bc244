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

/// Order of the displacement in the L2 norm with mean dilatation. It is p + 1, with the degree p of
/// the displacement, if the pressure has at least degree p - 1. tet10 and wedge15 have p = 2 and a
/// constant pressure (fem/locking/volumetric_integration.h), which reduces the order by one
/// (\cite boffi2013).
[[nodiscard]] constexpr double averaged_order(mesh::ElementShape shape) {
  return shape == mesh::ElementShape::kHex20 ? 3.0 : 2.0;
}

[[nodiscard]] inline std::string text_of(mesh::ElementShape shape) {
  return std::string(mesh::name_of(shape));
}

}  // namespace lefort::verify
