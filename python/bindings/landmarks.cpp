#include <lefort/io/landmarks_file.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/plan/cephalometrics.h>
#include <lefort/plan/landmarks.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "call.h"
#include "docstring.h"
#include "plans.h"
#include "volumes.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;

/// From {name: (x, y, z)}.
plan::Landmarks landmarks_of(const py::dict& points_L) {
  plan::Landmarks landmarks;
  for (const auto& [key, point] : points_L) {
    if (!py::isinstance<py::str>(key)) raise_invalid("the name of a landmark is no text");
    const auto name = key.cast<std::string>();
    landmarks.push_back({name, vector_of(py::reinterpret_borrow<py::object>(point), name.c_str())});
  }
  return value_of(io::checked_landmarks(std::move(landmarks)));
}

py::dict points_of(const plan::Landmarks& landmarks) {
  py::dict points_L;
  for (const auto& [name, point_L] : landmarks) points_L[py::str(name)] = array_of(point_L);
  return points_L;
}

/// (points, uncertainties, missing, point and normal of the mid-sagittal plane).
py::tuple find_landmarks(const OwnedCt& ct, const OwnedLabels& labels,
                         const anatomy::LevelOptions& levels, const CallOptions& options) {
  check_same_grid((*ct).grid, (*labels).grid);
  const plan::LandmarkSearch search = call(options, [&](Progress& progress) {
    return pipeline::find_head_landmarks(*ct, *labels, levels, progress);
  });
  py::dict uncertainty_mm, missing;
  for (const auto& [landmark, uncertainty] : search.found)
    uncertainty_mm[py::str(landmark.name)] = uncertainty;
  for (const auto& [name, reason] : search.missing) missing[py::str(name)] = reason;
  return py::make_tuple(points_of(search.landmarks()), uncertainty_mm, missing,
                        array_of(search.mid_sagittal_L.point),
                        array_of(search.mid_sagittal_L.normal));
}

/// A list of (name, meaning, unit, value or None).
py::list measure(const py::dict& points_L, const std::optional<py::dict>& frame) {
  const plan::Landmarks landmarks = landmarks_of(points_L);
  py::list rows;
  for (const plan::Measurement& row :
       value_of(plan::measure(landmarks, frame ? landmarks_of(*frame) : landmarks)))
    rows.append(py::make_tuple(row.name, row.meaning, row.unit, row.value));
  return rows;
}

}  // namespace

void bind_landmarks(py::module_& module) {
  const anatomy::LevelOptions defaults;
  module.def(
      "find_landmarks",
      [](const OwnedCt& ct, const OwnedLabels& labels, double bone_hu, double skin_hu,
         const py::object& progress, const std::shared_ptr<CancelToken>& cancel, int threads) {
        return find_landmarks(ct, labels, {.bone_hu = bone_hu, .skin_hu = skin_hu},
                              {progress, cancel, threads});
      },
      py::arg("ct"), py::arg("labels"), py::kw_only(), py::arg("bone_hu") = defaults.bone_hu,
      py::arg("skin_hu") = defaults.skin_hu, py::arg("progress") = py::none(),
      py::arg("cancel") = py::none(), py::arg("threads") = 0, doc("plan::find_landmarks"));
  module.def("measure", &measure, py::arg("landmarks"), py::arg("frame") = py::none(),
             doc("plan::measure"));
  module.def(
      "read_landmarks",
      [](const fs::path& file) {
        return points_of(
            call({py::none(), nullptr, 0}, [&](Progress&) { return io::read_landmarks(file); }));
      },
      py::arg("file"), doc("io::read_landmarks"));
  module.def(
      "write_landmarks",
      [](const fs::path& file, const py::dict& landmarks) {
        value_of(io::write_landmarks(file, landmarks_of(landmarks)));
      },
      py::arg("file"), py::arg("landmarks"), doc("io::write_landmarks"));
}

}  // namespace lefort::python
