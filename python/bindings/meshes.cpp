#include "meshes.h"

#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/surface_files.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <string>

#include "arrays.h"
#include "call.h"
#include "docstring.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;
using geometry::TriangleMesh;
using Integers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

std::vector<geometry::Triangle> triangles_of(const py::object& given) {
  const auto array = py::array::ensure(given);
  if (!array) {
    PyErr_Clear();
    raise_invalid("triangles is no array of numbers");
  }
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u')
    raise_invalid(fmt::format("triangles has the type {}; integers wanted",
                              py::str(array.dtype()).cast<std::string>()));
  if (array.ndim() != 2 || array.shape(1) != 3)
    raise_invalid("triangles must have the shape (m, 3)");
  const auto numbers = Integers::ensure(array);
  std::vector<geometry::Triangle> triangles(std::size_t(numbers.shape(0)));
  for (py::ssize_t n = 0; n < numbers.size(); ++n) {
    const std::int64_t vertex = numbers.data()[n];
    if (vertex < 0 || vertex > std::numeric_limits<std::int32_t>::max())
      raise({ErrorCode::kMeshInvalid, fmt::format("triangle {} has the vertex {}", n / 3, vertex)});
    triangles[std::size_t(n / 3)][std::size_t(n % 3)] = std::int32_t(vertex);
  }
  return triangles;
}

SharedMesh from_arrays(const py::object& vertices, const py::object& triangles) {
  const Points points(vertices, "vertices");
  if (points.shape().size() != 1) raise_invalid("vertices must have the shape (n, 3)");
  TriangleMesh mesh{{points.all().begin(), points.all().end()}, triangles_of(triangles)};
  value_of(geometry::check_surface(mesh));
  return shared(std::move(mesh));
}

py::array vertices_of(const py::object& self) {
  return view_of(self.cast<const TriangleMesh&>().vertices, self);
}

py::array triangles_view(const py::object& self) {
  const auto& triangles = self.cast<const TriangleMesh&>().triangles;
  return view_of(reinterpret_cast<const std::int32_t*>(triangles.data()),
                 {py::ssize_t(triangles.size()), 3}, self);
}

/// A quantity at every vertex, (n,) or (n, 3).
io::VertexArray vertex_array(const std::string& name, const py::object& given) {
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!array) {
    PyErr_Clear();
    raise_invalid(fmt::format("the array {} is no array of numbers", name));
  }
  if (array.ndim() == 1)
    return {name, std::vector<double>(array.data(), array.data() + array.size())};
  if (array.ndim() != 2 || array.shape(1) != 3)
    raise_invalid(fmt::format("the array {} must have the shape (n,) or (n, 3)", name));
  const auto* const first = reinterpret_cast<const Vec3*>(array.data());
  return {name, std::vector<Vec3>(first, first + array.shape(0))};
}

void write_surface(const fs::path& path, const TriangleMesh& mesh_L,
                   const std::map<std::string, py::object>& arrays) {
  std::vector<io::VertexArray> written;
  for (const auto& [name, values] : arrays) written.push_back(vertex_array(name, values));
  call({py::none(), nullptr, 0},
       [&](Progress&) { return io::write_surface(path, mesh_L, written); });
}

/// Exact distances; the tree holds a copy of the surface.
py::array_t<double> signed_distance(const geometry::Bvh& tree, const py::object& given) {
  const Points points(given, "points");
  const auto all = points.all();
  if (!std::all_of(all.begin(), all.end(), [](const Vec3& p) { return p.allFinite(); }))
    raise_invalid("points has a coordinate that is not finite");
  py::array_t<double> distances(points.shape());
  double* const out = distances.mutable_data();
  const WithoutGil without_gil;
  parallel_for(points.count(),
               [&](Index n) { out[n] = tree.signed_distance(all[std::size_t(n)]).distance_mm; });
  return distances;
}

std::shared_ptr<geometry::Bvh> make_tree(const TriangleMesh& mesh) {
  return call({py::none(), nullptr, 0}, [&](Progress&) -> Result<std::shared_ptr<geometry::Bvh>> {
    return std::make_shared<geometry::Bvh>(geometry::weld_vertices(mesh));
  });
}

std::string describe(const TriangleMesh& mesh) {
  return fmt::format("<lefort.TriangleMesh: {} vertices, {} triangles>", mesh.vertex_count(),
                     mesh.triangle_count());
}

}  // namespace

void bind_meshes(py::module_& module) {
  py::class_<TriangleMesh, SharedMesh>(module, "TriangleMesh", doc("geometry::TriangleMesh"))
      .def(py::init(&from_arrays), py::arg("vertices"), py::arg("triangles"),
           doc("geometry::check_surface"))
      .def_property_readonly("vertices", &vertices_of, doc("geometry::TriangleMesh::vertices"))
      .def_property_readonly("triangles", &triangles_view, doc("geometry::Triangle"))
      .def_property_readonly("area_mm2", &geometry::area_mm2, doc("geometry::area_mm2"))
      .def_property_readonly("signed_volume_mm3", &geometry::signed_volume_mm3,
                             doc("geometry::signed_volume_mm3"))
      .def_property_readonly("is_closed", &geometry::is_closed, doc("geometry::is_closed"))
      .def("__repr__", &describe)
      .def(py::pickle(
          [](const py::object& self) {
            return py::make_tuple(vertices_of(self), triangles_view(self));
          },
          [](const py::tuple& state) {
            if (state.size() != 2) raise_invalid("the pickled surface is damaged");
            return from_arrays(state[0], state[1]);
          }));
  py::class_<geometry::Bvh, std::shared_ptr<geometry::Bvh>>(module, "Bvh", doc("geometry::Bvh"))
      .def(py::init(&make_tree), py::arg("mesh"))
      .def("signed_distance", &signed_distance, py::arg("points"),
           doc("geometry::Bvh::signed_distance"))
      .def("__repr__", [](const geometry::Bvh& tree) {
        return fmt::format("<lefort.Bvh: {} triangles>", tree.mesh().triangle_count());
      });
  module.def(
      "read_surface",
      [](const fs::path& path) {
        return shared(call({py::none(), nullptr, 0},
                           [&](Progress& progress) { return io::read_surface(path, progress); }));
      },
      py::arg("path"), doc("io::read_surface"));
  module.def("write_surface", &write_surface, py::arg("path"), py::arg("mesh_L"),
             py::arg("arrays") = std::map<std::string, py::object>{}, doc("io::write_surface"));
}

}  // namespace lefort::python
