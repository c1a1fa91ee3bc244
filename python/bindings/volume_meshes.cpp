#include <lefort/io/read_vtu.h>
#include <lefort/io/volume_mesh_files.h>
#include <lefort/mesh/volume_mesh.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>
#include <string>

#include "arrays.h"
#include "call.h"
#include "docstring.h"
#include "meshes.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;
using mesh::VolumeMesh;

/// Elements of one shape, and the mesh that they belong to.
struct OwnedBlock {
  std::shared_ptr<VolumeMesh> mesh;
  std::size_t number;

  [[nodiscard]] const mesh::ElementBlock& operator*() const { return mesh->blocks[number]; }
};

py::array element_nodes(const py::object& self) {
  const mesh::ElementBlock& block = *self.cast<const OwnedBlock&>();
  return view_of(block.nodes.data(), {block.element_count(), mesh::node_count(block.shape)}, self);
}

py::array element_regions(const py::object& self) {
  const mesh::ElementBlock& block = *self.cast<const OwnedBlock&>();
  return view_of(block.region.data(), {block.element_count()}, self);
}

py::tuple blocks_of(const std::shared_ptr<VolumeMesh>& mesh) {
  py::tuple blocks(mesh->blocks.size());
  for (std::size_t n = 0; n < mesh->blocks.size(); ++n) blocks[n] = OwnedBlock{mesh, n};
  return blocks;
}

py::dict node_sets_of(const py::object& self) {
  py::dict sets;
  for (const auto& [name, nodes] : self.cast<const VolumeMesh&>().node_sets)
    sets[py::str(name)] = view_of(nodes.data(), {py::ssize_t(nodes.size())}, self);
  return sets;
}

py::array_t<double> node_vectors(const fs::path& file, const std::string& name) {
  auto* const vectors = new std::vector<Vec3>(
      call({py::none(), nullptr, 0}, [&](Progress&) { return io::read_vtu_vectors(file, name); }));
  const py::capsule owner(vectors,
                          [](void* held) { delete static_cast<std::vector<Vec3>*>(held); });
  return view_of(*vectors, owner);
}

}  // namespace

void bind_volume_meshes(py::module_& module) {
  py::class_<OwnedBlock>(module, "ElementBlock", doc("mesh::ElementBlock"))
      .def_property_readonly(
          "shape", [](const OwnedBlock& block) { return std::string(name_of((*block).shape)); },
          doc("mesh::ElementShape"))
      .def_property_readonly("nodes", &element_nodes, doc("mesh::ElementBlock::nodes"))
      .def_property_readonly("region", &element_regions, doc("mesh::ElementBlock::region"))
      .def("__repr__", [](const OwnedBlock& block) {
        return fmt::format("<lefort.ElementBlock: {} {}>", (*block).element_count(),
                           name_of((*block).shape));
      });
  py::class_<VolumeMesh, std::shared_ptr<VolumeMesh>>(module, "VolumeMesh", doc("mesh::VolumeMesh"))
      .def_property_readonly(
          "nodes_L",
          [](const py::object& self) {
            return view_of(self.cast<const VolumeMesh&>().nodes_L, self);
          },
          "Positions of the nodes, (n, 3) [mm], as a read-only view.")
      .def_property_readonly("blocks", &blocks_of, doc("mesh::ElementBlock"))
      .def_readonly("region_names", &VolumeMesh::region_names,
                    doc("mesh::VolumeMesh::region_names"))
      .def_property_readonly("node_sets", &node_sets_of, doc("mesh::VolumeMesh::node_sets"))
      .def("__repr__", [](const VolumeMesh& mesh) {
        return fmt::format("<lefort.VolumeMesh: {} nodes, {} elements>", mesh.node_count(),
                           mesh.element_count());
      });
  module.def(
      "read_volume_mesh",
      [](const fs::path& file, const std::string& regions) {
        return std::make_shared<VolumeMesh>(call({py::none(), nullptr, 0}, [&](Progress&) {
          return io::read_volume_mesh(file, regions);
        }));
      },
      py::arg("file"), py::kw_only(), py::arg("regions") = "", doc("io::read_volume_mesh"));
  module.def("read_vtu_vectors", &node_vectors, py::arg("file"), py::arg("name"),
             doc("io::read_vtu_vectors"));
}

}  // namespace lefort::python
