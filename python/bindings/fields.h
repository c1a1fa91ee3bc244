/// \file
/// Distance fields as Python objects.
#pragma once

#include <pybind11/pybind11.h>

namespace lefort::python {

void bind_fields(pybind11::module_& module);

}  // namespace lefort::python
