#include "volumes.h"

#include <lefort/image/check_grid.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/volume_files.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstring>
#include <filesystem>

#include "arrays.h"
#include "call.h"
#include "docstring.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;

constexpr const char* kConstructor =
    "A volume from a NumPy array, shape (z, y, x), which is copied once; empty() avoids the "
    "copy.\n\n"
    "Parameters:\n"
    "    spacing_mm, origin_L: along x, y and z.\n"
    "    direction: 3 by 3 rotation; its columns are the axes of the indices in frame L. None: "
    "the\n"
    "        axes of L.\n\n"
    "Raises InvalidArgument for another type of values, or a grid out of range.";

/// The type of NumPy that has the bits of a value.
template <class Value>
struct NumberOf {
  using Type = Value;
};
template <>
struct NumberOf<anatomy::Tissue> {
  using Type = std::uint8_t;
};
template <class Value>
using Number = typename NumberOf<Value>::Type;

image::Grid grid_of(const std::array<py::ssize_t, 3>& shape, const py::object& spacing_mm,
                    const py::object& origin_L, const py::object& direction) {
  image::Grid grid;
  grid.size = {shape[2], shape[1], shape[0]};
  grid.spacing_mm = vector_of(spacing_mm, "spacing_mm");
  grid.origin_L = vector_of(origin_L, "origin_L");
  if (!direction.is_none()) grid.direction = matrix_of(direction, "direction");
  if (const Result<void> checked = image::check_grid(grid); !checked)
    raise_invalid(checked.error().message);
  return grid;
}

/// Labels above the last tissue would be undefined.
void check_values(const std::vector<anatomy::Tissue>& values) {
  for (const anatomy::Tissue tissue : values)
    if (tissue > anatomy::Tissue::kMuscle)
      raise_invalid(
          fmt::format("a label is {}; 0 to {} wanted", int(tissue), int(anatomy::Tissue::kMuscle)));
}
void check_values(const std::vector<float>&) {}
void check_values(const std::vector<std::int16_t>&) {}

template <class Value>
OwnedVolume<Value> from_array(const py::array& values, const py::object& spacing_mm,
                              const py::object& origin_L, const py::object& direction) {
  using Element = Number<Value>;
  if (!py::isinstance<py::array_t<Element>>(values))
    raise_invalid(fmt::format("the values have the type {}; {} wanted: convert them with .astype()",
                              py::str(values.dtype()).cast<std::string>(),
                              py::str(py::dtype::of<Element>()).cast<std::string>()));
  if (values.ndim() != 3)
    raise_invalid(fmt::format("the values have {} dimensions; 3 wanted: z, y, x", values.ndim()));
  const auto rows = py::array_t<Element, py::array::c_style>::ensure(values);
  image::Volume<Value> volume;
  volume.grid =
      grid_of({rows.shape(0), rows.shape(1), rows.shape(2)}, spacing_mm, origin_L, direction);
  volume.values.resize(std::size_t(rows.size()));
  std::memcpy(volume.values.data(), rows.data(), volume.values.size() * sizeof(Value));
  check_values(volume.values);
  return owned(std::move(volume));
}

template <class Value>
OwnedVolume<Value> empty(const std::array<py::ssize_t, 3>& shape, const py::object& spacing_mm,
                         const py::object& origin_L, const py::object& direction) {
  image::Volume<Value> volume;
  volume.grid = grid_of(shape, spacing_mm, origin_L, direction);
  volume.values.resize(std::size_t(volume.grid.voxel_count()));
  OwnedVolume<Value> made = owned(std::move(volume));
  made.is_writable = true;
  return made;
}

template <class Value>
py::array values_view(const py::object& self) {
  const auto& held = self.cast<const OwnedVolume<Value>&>();
  const auto& size = (*held).grid.size;
  return view_of(reinterpret_cast<const Number<Value>*>((*held).values.data()),
                 {size[2], size[1], size[0]}, self, held.is_writable);
}

/// From (i, j, k, 1) to (x, y, z, 1).
py::array_t<double> affine_of(const image::Grid& grid) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> affine = Eigen::Matrix4d::Identity();
  affine.topLeftCorner<3, 3>() = grid.direction * grid.spacing_mm.asDiagonal();
  affine.topRightCorner<3, 1>() = grid.origin_L;
  return py::array_t<double>(std::vector<py::ssize_t>{4, 4}, affine.data());
}

template <class Value>
py::tuple state_of(const py::object& self) {
  const auto& grid = (*self.cast<const OwnedVolume<Value>&>()).grid;
  return py::make_tuple(values_view<Value>(self), array_of(grid.spacing_mm),
                        array_of(grid.origin_L), array_of(grid.direction));
}

/// Properties of the grid.
template <class Value>
void bind_grid(py::class_<OwnedVolume<Value>>& volume) {
  using Owned = OwnedVolume<Value>;
  volume
      .def_property_readonly(
          "spacing_mm", [](const Owned& self) { return array_of((*self).grid.spacing_mm); },
          "Distance of neighboring voxels along the indices i (x), j (y) and k (z) [mm].")
      .def_property_readonly(
          "origin_L", [](const Owned& self) { return array_of((*self).grid.origin_L); },
          doc("image::Grid::origin_L"))
      .def_property_readonly(
          "direction", [](const Owned& self) { return array_of((*self).grid.direction); },
          doc("image::Grid::direction"))
      .def_property_readonly(
          "affine_LV", [](const Owned& self) { return affine_of((*self).grid); },
          "4 by 4 matrix from voxel indices (i, j, k, 1) to a point of frame L (x, y, z, 1) [mm].");
}

/// What all volumes have; `values` is the name of the property with the array.
template <class Value>
py::class_<OwnedVolume<Value>> bind_volume(py::module_& module, const char* name,
                                           const char* values, const char* description) {
  using Owned = OwnedVolume<Value>;
  py::class_<Owned> volume(module, name, description);
  const py::tuple one = py::make_tuple(1.0, 1.0, 1.0), zero = py::make_tuple(0.0, 0.0, 0.0);
  volume
      .def(py::init(&from_array<Value>), py::arg(values), py::kw_only(),
           py::arg("spacing_mm") = one, py::arg("origin_L") = zero,
           py::arg("direction") = py::none(), kConstructor)
      .def_static("empty", &empty<Value>, py::arg("shape"), py::kw_only(),
                  py::arg("spacing_mm") = one, py::arg("origin_L") = zero,
                  py::arg("direction") = py::none(),
                  "A volume of zeros whose array is writable: fill it in place, without a copy.")
      .def_property_readonly(
          values, &values_view<Value>,
          "The values, shape (z, y, x), as a view. It is read-only, except for a\n"
          "volume made with empty().")
      .def_property_readonly(
          "shape",
          [](const Owned& self) {
            const auto& size = (*self).grid.size;
            return py::make_tuple(size[2], size[1], size[0]);
          },
          "Voxels along z, y and x: the shape of the array.")
      .def(
          "__array__",
          [](const py::object& self, const py::object& dtype, const py::object& copy) {
            const py::array view = values_view<Value>(self);
            if (!copy.is_none() && copy.cast<bool>())
              return py::object(
                  view.attr("astype")(dtype.is_none() ? py::object(view.dtype()) : dtype));
            if (dtype.is_none()) return py::object(view);
            return py::object(view.attr("astype")(dtype, py::arg("copy") = false));
          },
          py::arg("dtype") = py::none(), py::arg("copy") = py::none())
      .def("__repr__",
           [name](const Owned& self) {
             const auto& [size, spacing_mm, origin_L, direction] = (*self).grid;
             return fmt::format(
                 "<lefort.{}: {} x {} x {} voxels (z, y, x), {:g} x {:g} x {:g} mm (x, y, "
                 "z)>",
                 name, size[2], size[1], size[0], spacing_mm.x(), spacing_mm.y(), spacing_mm.z());
           })
      .def(py::pickle([](const py::object& self) { return state_of<Value>(self); },
                      [](const py::tuple& state) {
                        if (state.size() != 4) raise_invalid("the pickled volume is damaged");
                        return from_array<Value>(state[0].cast<py::array>(), state[1], state[2],
                                                 state[3]);
                      }));
  bind_grid(volume);
  return volume;
}

OwnedCt import_scan(const fs::path& source, int series, const std::string& user,
                    const std::string& password, const CallOptions& options) {
  const io::ImportOptions import{series, {user, password}};
  io::ImportedVolume scan = call(
      options, [&](Progress& progress) { return io::import_volume(source, import, progress); });
  OwnedCt ct = owned(std::move(scan.ct));
  ct.warnings = std::move(scan.warnings);
  ct.source_kind = std::move(scan.source_kind);
  return ct;
}

template <class Value>
void write_volume(const fs::path& target, const OwnedVolume<Value>& volume) {
  call({py::none(), nullptr, 0}, [&](Progress&) { return io::write_volume(target, *volume); });
}

}  // namespace

void check_same_grid(const image::Grid& ct, const image::Grid& labels) {
  if (!(ct == labels)) raise_invalid("ct and labels are not on the same grid");
}

void bind_volumes(py::module_& module) {
  bind_volume<std::int16_t>(module, "CtVolume", "hu", doc("image::CtVolume"))
      .def_readonly("warnings", &OwnedCt::warnings, doc("io::ImportedVolume::warnings"))
      .def_readonly("source_kind", &OwnedCt::source_kind, doc("io::ImportedVolume::source_kind"));
  bind_volume<float>(module, "ScalarVolume", "values", doc("image::ScalarVolume"));
  bind_volume<anatomy::Tissue>(module, "LabelMap", "labels", doc("anatomy::LabelMap"));
  module.def(
      "import_scan",
      [](const fs::path& source, int series, const std::string& user, const std::string& password,
         const py::object& progress, const std::shared_ptr<CancelToken>& cancel, int threads) {
        return import_scan(source, series, user, password, {progress, cancel, threads});
      },
      py::arg("source"), py::kw_only(), py::arg("series") = 0, py::arg("user") = "",
      py::arg("password") = "", py::arg("progress") = py::none(), py::arg("cancel") = py::none(),
      py::arg("threads") = 0, doc("io::import_volume"));
  module.def("write_volume", &write_volume<std::int16_t>, py::arg("target"), py::arg("volume"),
             doc("io::write_volume"));
  module.def("write_volume", &write_volume<float>, py::arg("target"), py::arg("volume"),
             doc("io::write_volume"));
}

}  // namespace lefort::python
