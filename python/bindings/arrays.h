/// \file
/// NumPy arrays: views of C++ memory, and points from Python.
#pragma once

#include <lefort/core/types.h>

#include <pybind11/numpy.h>

#include <array>
#include <span>
#include <vector>

#include "errors.h"

namespace lefort::python {

static_assert(sizeof(Vec3) == 3 * sizeof(double));

/// An array over memory of `owner`, which lives as long as the array.
template <class T>
[[nodiscard]] pybind11::array_t<T> view_of(const T* data, std::vector<pybind11::ssize_t> shape,
                                           const pybind11::object& owner,
                                           bool is_writable = false) {
  pybind11::array_t<T> view(std::move(shape), data, owner);
  if (!is_writable) view.attr("flags").attr("writeable") = false;
  return view;
}

/// (n, 3) float64 over a list of vectors.
[[nodiscard]] pybind11::array_t<double> view_of(const std::vector<Vec3>& points,
                                                const pybind11::object& owner);

/// Points of a call: shape (..., 3), float64, contiguous.
class Points {
 public:
  /// \param given  any array-like; converted if necessary.
  /// \param name   of the argument, for messages.
  Points(const pybind11::object& given, const char* name);

  [[nodiscard]] std::span<const Vec3> all() const;
  [[nodiscard]] Index count() const { return Index(all().size()); }
  /// The shape without its last dimension, followed by `last`.
  [[nodiscard]] std::vector<pybind11::ssize_t> shape(std::initializer_list<int> last = {}) const;

 private:
  pybind11::array_t<double> array_;
};

/// Three numbers from Python.
[[nodiscard]] Vec3 vector_of(const pybind11::object& given, const char* name);
/// Three by three numbers from Python.
[[nodiscard]] Mat3 matrix_of(const pybind11::object& given, const char* name);

/// Copies, as small arrays.
[[nodiscard]] pybind11::array_t<double> array_of(const Vec3& vector);
[[nodiscard]] pybind11::array_t<double> array_of(const Mat3& matrix);

}  // namespace lefort::python
