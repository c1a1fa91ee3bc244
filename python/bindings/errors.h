/// \file
/// Errors as Python exceptions.
#pragma once

#include <lefort/core/error.h>

#include <pybind11/pybind11.h>

#include <utility>

namespace lefort::python {

/// Adds the exception Error, and one class of it for each ErrorCode.
void bind_errors(pybind11::module_& module);

/// Raises the exception of an error, with its message. Needs the GIL.
[[noreturn]] void raise(const Error& error);

/// Raises InvalidArgument, which is also a ValueError.
[[noreturn]] void raise_invalid(const std::string& message);

/// Returns the value of a result, or raises its error. Needs the GIL.
template <class T>
T value_of(Result<T>&& result) {
  if (!result) raise(result.error());
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

}  // namespace lefort::python
