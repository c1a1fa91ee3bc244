#include "tasks.h"

#include <lefort/pipeline/compare.h>
#include <lefort/pipeline/predict.h>
#include <lefort/pipeline/solve.h>

#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "docstring.h"
#include "run_task.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;

using OptionalPath = std::optional<fs::path>;
using Token = std::shared_ptr<CancelToken>;

TaskResult predict_case(const fs::path& plan, const OptionalPath& ct, const fs::path& output,
                        bool pictures, bool sensitivity, const CallOptions& options) {
  return run_task(options, [&](Progress& progress) {
    return pipeline::predict_case({.plan = plan,
                                   .ct = ct,
                                   .output = output,
                                   .pictures = pictures,
                                   .sensitivity = sensitivity},
                                  progress);
  });
}

}  // namespace

void bind_tasks(py::module_& module) {
  module.def(
      "predict_case",
      [](const fs::path& plan, const OptionalPath& ct, const fs::path& output, bool pictures,
         bool sensitivity, const py::object& progress, const Token& cancel, int threads) {
        return predict_case(plan, ct, output, pictures, sensitivity, {progress, cancel, threads});
      },
      py::arg("plan"), py::arg("ct"), py::arg("output"), py::arg("pictures"),
      py::arg("sensitivity"), py::arg("progress"), py::arg("cancel"), py::arg("threads"),
      doc("pipeline::predict_case"));
  module.def(
      "solve_deck",
      [](const fs::path& deck, const fs::path& output, bool check_only, const py::object& progress,
         const Token& cancel, int threads) {
        return run_task({progress, cancel, threads}, [&](Progress& inner) {
          return pipeline::solve_deck(
              {.quiet = false, .deck = deck, .output = output, .check_only = check_only}, inner);
        });
      },
      py::arg("deck"), py::arg("output"), py::arg("check_only"), py::arg("progress"),
      py::arg("cancel"), py::arg("threads"), doc("pipeline::solve_deck"));
  module.def(
      "compare_faces",
      [](const fs::path& face, const OptionalPath& other, const OptionalPath& after_ct,
         const OptionalPath& before, const OptionalPath& landmarks, const fs::path& output,
         bool pictures, const py::object& progress, const Token& cancel, int threads) {
        return run_task({progress, cancel, threads}, [&](Progress& inner) {
          return pipeline::compare_faces(
              {face, other, after_ct, before, landmarks, output, pictures}, inner);
        });
      },
      py::arg("face"), py::arg("other"), py::arg("after_ct"), py::arg("before"),
      py::arg("landmarks"), py::arg("output"), py::arg("pictures"), py::arg("progress"),
      py::arg("cancel"), py::arg("threads"), doc("pipeline::compare_faces"));
}

}  // namespace lefort::python
