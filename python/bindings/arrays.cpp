#include "arrays.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>

namespace lefort::python {
namespace {

namespace py = pybind11;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Raises InvalidArgument unless the array consists of numbers; complex ones are none.
py::array numbers_of(const py::object& given, const char* name) {
  const auto array = py::array::ensure(given);
  if (!array) {
    PyErr_Clear();
    raise_invalid(fmt::format("{} is no array of numbers", name));
  }
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    raise_invalid(fmt::format("{} has the type {}; real numbers wanted", name,
                              py::str(array.dtype()).cast<std::string>()));
  return array;
}

std::string shape_of(const py::array& array) {
  return fmt::format("({})", fmt::join(array.shape(), array.shape() + array.ndim(), ", "));
}

Doubles doubles_of(const py::object& given, const char* name) {
  return Doubles::ensure(numbers_of(given, name));
}

}  // namespace

py::array_t<double> view_of(const std::vector<Vec3>& points, const py::object& owner) {
  return view_of(reinterpret_cast<const double*>(points.data()), {py::ssize_t(points.size()), 3},
                 owner);
}

Points::Points(const py::object& given, const char* name) : array_(doubles_of(given, name)) {
  if (array_.ndim() < 1 || array_.shape(array_.ndim() - 1) != 3)
    raise_invalid(fmt::format("{} has the shape {}; (..., 3) wanted", name, shape_of(array_)));
}

std::span<const Vec3> Points::all() const {
  return {reinterpret_cast<const Vec3*>(array_.data()), std::size_t(array_.size() / 3)};
}

std::vector<py::ssize_t> Points::shape(std::initializer_list<int> last) const {
  std::vector<py::ssize_t> shape(array_.shape(), array_.shape() + array_.ndim() - 1);
  shape.insert(shape.end(), last.begin(), last.end());
  return shape;
}

Vec3 vector_of(const py::object& given, const char* name) {
  const Doubles array = doubles_of(given, name);
  if (array.ndim() != 1 || array.shape(0) != 3)
    raise_invalid(fmt::format("{} has the shape {}; (3,) wanted", name, shape_of(array)));
  return {array.data()[0], array.data()[1], array.data()[2]};
}

Mat3 matrix_of(const py::object& given, const char* name) {
  const Doubles array = doubles_of(given, name);
  if (array.ndim() != 2 || array.shape(0) != 3 || array.shape(1) != 3)
    raise_invalid(fmt::format("{} has the shape {}; (3, 3) wanted", name, shape_of(array)));
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(array.data());
}

py::array_t<double> array_of(const Vec3& vector) {
  return py::array_t<double>(std::vector<py::ssize_t>{3}, vector.data());
}

py::array_t<double> array_of(const Mat3& matrix) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = matrix;
  return py::array_t<double>(std::vector<py::ssize_t>{3, 3}, rows.data());
}

}  // namespace lefort::python
