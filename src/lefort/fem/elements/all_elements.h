/// \file
/// The closed set of element shapes the solver knows.
#pragma once

#include <lefort/fem/elements/tet10.h>
#include <lefort/fem/elements/tet4.h>
#include <lefort/mesh/volume_mesh.h>

#include <optional>
#include <variant>

namespace lefort::fem {

/// To add a shape: its file beside this one, and its name here.
using AnyElement = std::variant<Tet4, Tet10>;

namespace internal {

template <class... Elements>
std::optional<std::variant<Elements...>> find_element(mesh::ElementShape shape,
                                                      const std::variant<Elements...>& /*set*/) {
  std::optional<std::variant<Elements...>> found;
  ((Elements::kShape == shape ? void(found = Elements{}) : void()), ...);
  return found;
}

}  // namespace internal

/// The element of that shape, for std::visit; nothing if the solver does not know it.
[[nodiscard]] inline std::optional<AnyElement> element_of(mesh::ElementShape shape) {
  return internal::find_element(shape, AnyElement{});
}

}  // namespace lefort::fem
