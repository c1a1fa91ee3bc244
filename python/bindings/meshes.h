/// \file
/// Surfaces and volume meshes as Python objects.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

namespace lefort::python {

/// A surface that Python and others own. It does not change.
using SharedMesh = std::shared_ptr<geometry::TriangleMesh>;

[[nodiscard]] inline SharedMesh shared(geometry::TriangleMesh mesh) {
  return std::make_shared<geometry::TriangleMesh>(std::move(mesh));
}

void bind_meshes(pybind11::module_& module);
void bind_volume_meshes(pybind11::module_& module);

}  // namespace lefort::python
