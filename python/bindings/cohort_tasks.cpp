#include <lefort/pipeline/import.h>
#include <lefort/pipeline/validate.h>

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "docstring.h"
#include "run_task.h"
#include "tasks.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;
using Token = std::shared_ptr<CancelToken>;

constexpr std::array<std::pair<const char*, pipeline::PhantomHead>, 2> kHeads{
    {{"simple", pipeline::PhantomHead::kSimple}, {"teeth", pipeline::PhantomHead::kTeeth}}};

pipeline::PhantomHead head_of(const std::string& name) {
  for (const auto& [known, head] : kHeads)
    if (name == known) return head;
  raise_invalid(fmt::format("head is \"{}\"; simple or teeth wanted", name));
}

/// The options come from Python, where NaN passes every comparison.
double checked(const char* name, double value, double low) {
  if (!(value >= low) || value > 1e3)
    raise_invalid(fmt::format("{} is {:g}, out of range", name, value));
  return value;
}

}  // namespace

void bind_cohort_tasks(py::module_& module) {
  module.def(
      "make_phantom",
      [](const fs::path& output, const std::string& head, double voxel_mm, double noise_hu,
         const py::object& progress, const Token& cancel, int threads) {
        const pipeline::PhantomJob job{output, head_of(head), pipeline::PhantomVariant::kPlain,
                                       checked("voxel_mm", voxel_mm, 0.2),
                                       checked("noise_hu", noise_hu, 0.0)};
        return run_task({progress, cancel, threads},
                        [&](Progress& inner) { return pipeline::make_phantom(job, inner); });
      },
      py::arg("output"), py::arg("head"), py::arg("voxel_mm"), py::arg("noise_hu"),
      py::arg("progress"), py::arg("cancel"), py::arg("threads"), doc("pipeline::make_phantom"));
  module.def(
      "make_phantom_cohort",
      [](const fs::path& output, int cases, double voxel_mm, double element_size_mm,
         std::uint64_t seed, const py::object& progress, const Token& cancel, int threads) {
        pipeline::PhantomCohortJob job{.output = output, .cases = cases};
        if (cases < 1 || cases > 1000) raise_invalid("cases must be 1 to 1000");
        job.voxel_mm = checked("voxel_mm", voxel_mm, 0.2);
        job.element_size_mm = checked("element_size_mm", element_size_mm, 0.5);
        job.seed = seed;
        return run_task({progress, cancel, threads},
                        [&](Progress& inner) { return pipeline::make_phantom_cohort(job, inner); });
      },
      py::arg("output"), py::arg("cases"), py::arg("voxel_mm"), py::arg("element_size_mm"),
      py::arg("seed"), py::arg("progress"), py::arg("cancel"), py::arg("threads"),
      doc("pipeline::make_phantom_cohort"));
  module.def(
      "validate_cohort",
      [](const fs::path& cohort, const fs::path& output, bool achieved_movements,
         std::optional<double> element_size_mm, double voxel_mm, bool pictures,
         const py::object& progress, const Token& cancel, int threads) {
        if (element_size_mm) checked("element_size_mm", *element_size_mm, 0.5);
        const pipeline::ValidateJob job{cohort,
                                        output,
                                        achieved_movements,
                                        element_size_mm,
                                        checked("voxel_mm", voxel_mm, 0.2),
                                        pictures};
        return run_task({progress, cancel, threads},
                        [&](Progress& inner) { return pipeline::validate_cohort(job, inner); });
      },
      py::arg("cohort"), py::arg("output"), py::arg("achieved_movements"),
      py::arg("element_size_mm"), py::arg("voxel_mm"), py::arg("pictures"), py::arg("progress"),
      py::arg("cancel"), py::arg("threads"), doc("pipeline::validate_cohort"));
}

}  // namespace lefort::python
