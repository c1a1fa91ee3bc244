/// \file
/// The boundary of an intersection of half-spaces.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <span>

namespace lefort::mesh {

/// The points p with normal . (p - point) >= 0.
struct HalfSpace {
  Vec3 point;   ///< Any point of the bounding plane [mm].
  Vec3 normal;  ///< Into the half-space; any length > 0.
};

/// \param half_spaces  any number; the time grows with its fourth power.
/// \param box          bounds the solid.
/// \returns the part of `box` that lies in every half-space, as a closed surface, counter-clockwise
///   seen from outside; empty if it has no volume.
[[nodiscard]] geometry::TriangleMesh convex_solid(std::span<const HalfSpace> half_spaces,
                                                  const Box3& box);

}  // namespace lefort::mesh
