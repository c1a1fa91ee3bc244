#include "errors.h"

#include <lefort/core/printable.h>

#include <array>
#include <cstddef>
#include <string>

#include "docstring.h"

namespace lefort::python {
namespace {

namespace py = pybind11;

/// An exception class of Python.
struct ErrorClass {
  ErrorCode code;
  const char* name;
  const char* code_name;  ///< Error.code.
  PyObject** builtin;     ///< Second base class, so that `except ValueError` and others hold.
  const char* description;
};

PyObject* none = nullptr;

/// In the order of ErrorCode.
const std::array kClasses{
    ErrorClass{ErrorCode::kInvalidArgument, "InvalidArgument", "invalid_argument",
               &PyExc_ValueError, doc("ErrorCode::kInvalidArgument")},
    ErrorClass{ErrorCode::kFileNotFound, "FileNotFound", "file_not_found", &PyExc_FileNotFoundError,
               doc("ErrorCode::kFileNotFound")},
    ErrorClass{ErrorCode::kFileCorrupt, "FileCorrupt", "file_corrupt", &PyExc_ValueError,
               doc("ErrorCode::kFileCorrupt")},
    ErrorClass{ErrorCode::kFileUnsupported, "FileUnsupported", "file_unsupported",
               &PyExc_ValueError, doc("ErrorCode::kFileUnsupported")},
    ErrorClass{ErrorCode::kFileUnwritable, "FileUnwritable", "file_unwritable", &PyExc_OSError,
               doc("ErrorCode::kFileUnwritable")},
    ErrorClass{ErrorCode::kPlanInvalid, "PlanInvalid", "plan_invalid", &PyExc_ValueError,
               doc("ErrorCode::kPlanInvalid")},
    ErrorClass{ErrorCode::kMeshInvalid, "MeshInvalid", "mesh_invalid", &PyExc_ValueError,
               doc("ErrorCode::kMeshInvalid")},
    ErrorClass{ErrorCode::kAnatomyMissing, "AnatomyMissing", "anatomy_missing", &none,
               doc("ErrorCode::kAnatomyMissing")},
    ErrorClass{ErrorCode::kCutMissesBone, "CutMissesBone", "cut_misses_bone", &none,
               doc("ErrorCode::kCutMissesBone")},
    ErrorClass{ErrorCode::kMeshingFailed, "MeshingFailed", "meshing_failed", &none,
               doc("ErrorCode::kMeshingFailed")},
    ErrorClass{ErrorCode::kElementInverted, "ElementInverted", "element_inverted", &none,
               doc("ErrorCode::kElementInverted")},
    ErrorClass{ErrorCode::kStepBeyondBand, "StepBeyondBand", "step_beyond_band", &none,
               doc("ErrorCode::kStepBeyondBand")},
    ErrorClass{ErrorCode::kNotConverged, "NotConverged", "not_converged", &none,
               doc("ErrorCode::kNotConverged")},
    ErrorClass{ErrorCode::kCancelled, "Cancelled", "cancelled", &none,
               doc("ErrorCode::kCancelled")},
    ErrorClass{ErrorCode::kOutOfMemory, "OutOfMemory", "out_of_memory", &PyExc_MemoryError,
               doc("ErrorCode::kOutOfMemory")},
    ErrorClass{ErrorCode::kAccessDenied, "AccessDenied", "access_denied", &PyExc_PermissionError,
               doc("ErrorCode::kAccessDenied")},
    ErrorClass{ErrorCode::kConnectionFailed, "ConnectionFailed", "connection_failed",
               &PyExc_ConnectionError, doc("ErrorCode::kConnectionFailed")},
};
static_assert(kClasses.size() == std::size_t(ErrorCode::kConnectionFailed) + 1);

/// The classes; they live as long as the process.
std::array<PyObject*, kClasses.size()>& exception_objects() {
  static std::array<PyObject*, kClasses.size()> objects{};
  return objects;
}

py::object new_exception(const std::string& name, const char* description, const py::tuple& bases,
                         const char* code_name) {
  py::dict members;
  members["code"] = code_name;
  PyObject* const made = PyErr_NewExceptionWithDoc(("lefort." + name).c_str(), description,
                                                   bases.ptr(), members.ptr());
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(made);
}

}  // namespace

void bind_errors(py::module_& module) {
  const auto base_class = py::reinterpret_borrow<py::object>(PyExc_Exception);
  const py::object error =
      new_exception("Error", doc("Error"), py::make_tuple(base_class), "error");
  module.attr("Error") = error;
  for (std::size_t n = 0; n < kClasses.size(); ++n) {
    const ErrorClass& one = kClasses[n];
    py::tuple bases = py::make_tuple(error);
    if (one.builtin != &none)
      bases = py::make_tuple(error, py::reinterpret_borrow<py::object>(*one.builtin));
    const py::object made = new_exception(one.name, one.description, bases, one.code_name);
    module.attr(one.name) = made;
    exception_objects()[n] = py::object(made).release().ptr();
  }
}

void raise(const Error& error) {
  PyErr_SetString(exception_objects()[std::size_t(error.code)], printable(error.message).c_str());
  throw py::error_already_set();
}

void raise_invalid(const std::string& message) { raise({ErrorCode::kInvalidArgument, message}); }

}  // namespace lefort::python
