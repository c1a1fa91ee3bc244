/// \file
/// The closed set of element shapes: all shapes of mesh::ElementShape.
#pragma once

#include <lefort/core/check.h>
#include <lefort/fem/elements/hex20.h>
#include <lefort/fem/elements/hex8.h>
#include <lefort/fem/elements/pyramid5.h>
#include <lefort/fem/elements/tet10.h>
#include <lefort/fem/elements/tet4.h>
#include <lefort/fem/elements/wedge15.h>
#include <lefort/fem/elements/wedge6.h>
#include <lefort/mesh/volume_mesh.h>

#include <optional>
#include <variant>

namespace lefort::fem {

/// To add a shape: add its file to this folder and its name here.
using AnyElement = std::variant<Tet4, Pyramid5, Wedge6, Hex8, Tet10, Wedge15, Hex20>;

namespace internal {

/// \returns the alternative of the set whose kShape is `shape`.
template <class... Shapes, class Kind>
std::variant<Shapes...> find_shape(Kind shape, const std::variant<Shapes...>& /*set*/) {
  std::optional<std::variant<Shapes...>> found;
  ((Shapes::kShape == shape ? void(found = Shapes{}) : void()), ...);
  LEFORT_CHECK(found.has_value());
  return *found;
}

}  // namespace internal

/// \returns the element of this shape, for std::visit.
[[nodiscard]] inline AnyElement element_of(mesh::ElementShape shape) {
  return internal::find_shape(shape, AnyElement{});
}

}  // namespace lefort::fem
