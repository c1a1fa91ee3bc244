#include "plans.h"

#include <lefort/io/plan_file.h>
#include <lefort/io/plan_schema.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <string>

#include "call.h"
#include "docstring.h"

namespace lefort::python {

namespace py = pybind11;

void bind_plans(py::module_& module) {
  module.attr("PLAN_SCHEMA") = io::kPlanSchema;
  module.def(
      "check_plan",
      [](const std::string& json, const std::filesystem::path& folder) {
        return call({py::none(), nullptr, 0},
                    [&](Progress&) { return io::check_plan(json, folder); });
      },
      py::arg("json"), py::arg("folder"), doc("io::check_plan"));
  module.def(
      "check_plan_form", [](const std::string& json) { value_of(io::check_plan_form(json)); },
      py::arg("json"), doc("io::check_plan_form"));
  module.def(
      "rename_plan_keys",
      [](const std::string& json) { return value_of(io::rename_plan_keys(json)); }, py::arg("json"),
      doc("io::rename_plan_keys"));
}

}  // namespace lefort::python
