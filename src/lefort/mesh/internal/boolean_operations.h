/// \file
/// Boolean operations on closed surfaces by corefinement (CGAL). Only boolean_operations.cpp
/// instantiates its templates, because they are among those that take longest to compile.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <optional>

namespace lefort::mesh::internal {

/// The wanted results; one of them takes less time than all.
struct BooleanRequest {
  bool in_either = false;      ///< The union.
  bool in_both = false;        ///< The intersection.
  bool in_first_only = false;  ///< The difference.
};

/// The wanted results; nothing where the result would not be a surface.
struct BooleanResult {
  std::optional<geometry::TriangleMesh> in_either, in_both, in_first_only;
};

/// \param first, second  closed surfaces with outward normals.
/// \param wanted         the operations to be computed.
/// \returns the results; all empty if a surface crosses itself where the other cuts it, or violates
///   a precondition of CGAL.
/// \throws std::bad_alloc
[[nodiscard]] BooleanResult boolean_operations(const geometry::TriangleMesh& first,
                                               const geometry::TriangleMesh& second,
                                               const BooleanRequest& wanted);

}  // namespace lefort::mesh::internal
