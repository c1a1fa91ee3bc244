/// \file
/// Plans and landmarks.
#pragma once

#include <pybind11/pybind11.h>

namespace lefort::python {

void bind_plans(pybind11::module_& module);
void bind_landmarks(pybind11::module_& module);

}  // namespace lefort::python
