#include <lefort/core/version.h>
#include <lefort/io/start_readers.h>

#include <pybind11/pybind11.h>

#include "call.h"
#include "docstring.h"
#include "errors.h"
#include "fields.h"
#include "meshes.h"
#include "plans.h"
#include "segmentation.h"
#include "tasks.h"
#include "volumes.h"

/// The compiled part of the Python package lefort.
PYBIND11_MODULE(_lefort, module) {
  namespace python = lefort::python;
  lefort::io::start_readers();  // First, while the process has few threads and little data.
  module.doc() = lefort::kNotForClinicalUse;
  module.attr("__version__") = lefort::kVersion;
  module.attr("NOTICE") = lefort::kNotForClinicalUse;
  pybind11::options options;
  options.disable_function_signatures();  // They are in _lefort.pyi, with types.
  python::bind_errors(module);
  python::bind_call(module);
  python::bind_volumes(module);
  python::bind_segmentation(module);
  python::bind_meshes(module);
  python::bind_surfaces(module);
  python::bind_volume_meshes(module);
  python::bind_fields(module);
  python::bind_plans(module);
  python::bind_landmarks(module);
  python::bind_tasks(module);
  python::bind_cohort_tasks(module);
}
