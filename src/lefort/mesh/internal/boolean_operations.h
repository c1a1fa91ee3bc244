/// \file
/// Boolean operations on closed surfaces by corefinement (CGAL). The only file that instantiates it: it
/// is among the most expensive templates of the whole build.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <optional>

namespace lefort::mesh::internal {

/// Results that are wanted; computing one alone is cheaper than all.
struct BooleanRequest {
  bool in_either = false;      ///< The union.
  bool in_both = false;        ///< The intersection.
  bool in_first_only = false;  ///< The difference.
};

/// What was wanted and is a surface; nothing where the result would not be one.
struct BooleanResult {
  std::optional<geometry::TriangleMesh> in_either, in_both, in_first_only;
};

/// \pre Both are closed surfaces with outward normals.
/// \returns all empty if a surface crosses itself where the other cuts it, or breaks a precondition of
///   CGAL.
/// \throws std::bad_alloc
[[nodiscard]] BooleanResult boolean_operations(const geometry::TriangleMesh& first,
                                               const geometry::TriangleMesh& second,
                                               const BooleanRequest& wanted);

}  // namespace lefort::mesh::internal
