/// \file
/// A tube around a polyline.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <span>

namespace lefort::geometry {

/// A closed tube with flat ends. Its corners are transported along the line without twist (double
/// reflection \cite wang2008).
///
/// \param line_L     two or more points; consecutive ones differ.
/// \param radius_mm  > 0.
/// \param corners    of a section, 3 or more.
/// \returns the tube, counter-clockwise seen from outside: vertex n * corners + c is corner c at
///   point n; the last two vertices are the first and the last point of the line.
[[nodiscard]] TriangleMesh tube_surface(std::span<const Vec3> line_L, double radius_mm,
                                        int corners);

}  // namespace lefort::geometry
