/// \file
/// The tasks of the command line: each returns its summary as JSON and its warnings.
#pragma once

#include <pybind11/pybind11.h>

namespace lefort::python {

void bind_tasks(pybind11::module_& module);
void bind_cohort_tasks(pybind11::module_& module);

}  // namespace lefort::python
