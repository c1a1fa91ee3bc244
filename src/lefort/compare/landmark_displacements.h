/// \file
/// Moves landmarks with the skin.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/landmarks.h>

#include <span>

namespace lefort::compare {

/// Displaces each landmark of the skin (landmark_definition()) by the displacement of the skin,
/// interpolated in the closest triangle.
///
/// \param landmarks_L        before the displacement; those that are not of the skin are ignored.
/// \param before_L, after_L  the same surface in two states: equal vertex counts and triangles.
/// \param near_mm            max distance of a landmark from the skin.
/// \returns the displaced landmarks within `near_mm` of the skin, in their order; or
///   kInvalidArgument if the vertex counts or triangles differ.
[[nodiscard]] Result<plan::Landmarks> displace_landmarks(
    std::span<const plan::Landmark> landmarks_L, const geometry::TriangleMesh& before_L,
    const geometry::TriangleMesh& after_L, double near_mm = 5.0);

}  // namespace lefort::compare
