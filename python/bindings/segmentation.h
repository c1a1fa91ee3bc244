/// \file
/// Segmentation and surfaces of a scan in memory.
#pragma once

#include <pybind11/pybind11.h>

namespace lefort::python {

void bind_segmentation(pybind11::module_& module);
void bind_surfaces(pybind11::module_& module);

}  // namespace lefort::python
