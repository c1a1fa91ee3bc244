/// \file
/// Where landmarks on a skin go with it.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/landmarks.h>

#include <span>

namespace lefort::compare {

/// Landmarks of the skin (landmark_definition()) as the skin carries them from one state to
/// another.
///
/// A landmark keeps its place in the nearest triangle, and its distance from it [mm] in L.
///
/// \param before_L, after_L  the same surface twice: as many vertices, the same triangles.
/// \returns those that lie within `near_mm` of the skin, in their order; or kInvalidArgument if the
///   two are not the same surface.
[[nodiscard]] Result<plan::Landmarks> carry_landmarks(std::span<const plan::Landmark> landmarks_L,
                                                      const geometry::TriangleMesh& before_L,
                                                      const geometry::TriangleMesh& after_L,
                                                      double near_mm = 5.0);

}  // namespace lefort::compare
