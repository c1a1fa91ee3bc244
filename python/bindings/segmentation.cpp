#include "segmentation.h"

#include <lefort/anatomy/histogram_thresholds.h>
#include <lefort/anatomy/reduce_metal_streaks.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/tissue_volumes.h>
#include <lefort/io/segmentation_file.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <string>

#include "call.h"
#include "docstring.h"
#include "volumes.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;
using anatomy::SegmentationOptions;
using anatomy::Tissue;

/// Tissue as an IntEnum, so that it compares with the values of an array.
void bind_tissue(py::module_& module) {
  py::dict members;
  members["BACKGROUND"] = int(Tissue::kBackground);
  members["BONE"] = int(Tissue::kBone);
  members["SOFT_TISSUE"] = int(Tissue::kSoftTissue);
  members["AIRWAY"] = int(Tissue::kAirway);
  members["BRAIN"] = int(Tissue::kBrain);
  members["SINUS"] = int(Tissue::kSinus);
  members["MANDIBLE"] = int(Tissue::kMandible);
  members["MUSCLE"] = int(Tissue::kMuscle);
  const py::object tissue = py::module_::import("enum").attr("IntEnum")(
      "Tissue", members, py::arg("module") = "lefort._lefort");
  tissue.attr("__doc__") = doc("anatomy::Tissue");
  module.attr("Tissue") = tissue;
}

OwnedLabels segment(const OwnedCt& ct, const SegmentationOptions& options,
                    const CallOptions& call_options) {
  return owned(call(call_options, [&](Progress& progress) {
    return anatomy::segment_tissue(*ct, options, progress);
  }));
}

OwnedCt reduce_streaks(const OwnedCt& ct, double bone_hu, double skin_hu,
                       const CallOptions& options) {
  OwnedCt reduced = owned(call(options, [&](Progress&) -> Result<image::CtVolume> {
    return anatomy::reduce_metal_streaks(*ct, bone_hu, skin_hu).ct;
  }));
  reduced.warnings = ct.warnings;
  reduced.source_kind = ct.source_kind;
  return reduced;
}

py::dict find_thresholds(const OwnedCt& ct) {
  const anatomy::HistogramThresholds found =
      call({py::none(), nullptr, 0}, [&](Progress&) { return anatomy::find_thresholds(*ct); });
  py::dict thresholds;
  thresholds["bone_hu"] = found.bone_hu;
  thresholds["skin_hu"] = found.skin_hu;
  return thresholds;
}

OwnedLabels read_segmentation(const fs::path& source, const OwnedCt* ct,
                              const CallOptions& options) {
  return owned(call(options, [&](Progress& progress) {
    return ct == nullptr ? io::read_segmentation(source)
                         : io::read_segmentation(source, (**ct).grid, progress);
  }));
}

void bind_files(py::module_& module) {
  module.def(
      "read_segmentation",
      [](const fs::path& source, const OwnedCt* ct, const py::object& progress,
         const std::shared_ptr<CancelToken>& cancel, int threads) {
        return read_segmentation(source, ct, {progress, cancel, threads});
      },
      py::arg("source"), py::kw_only(), py::arg("ct") = py::none(),
      py::arg("progress") = py::none(), py::arg("cancel") = py::none(), py::arg("threads") = 0,
      doc("io::read_segmentation"));
  module.def(
      "write_segmentation",
      [](const fs::path& target, const OwnedLabels& labels) {
        call({py::none(), nullptr, 0},
             [&](Progress&) { return io::write_segmentation(target, *labels); });
      },
      py::arg("target"), py::arg("labels"), doc("io::write_segmentation"));
}

}  // namespace

void bind_segmentation(py::module_& module) {
  bind_tissue(module);
  const SegmentationOptions defaults;
  module.def(
      "segment",
      [](const OwnedCt& ct, double bone_hu, double skin_hu, double min_bone_ml,
         double nostril_radius_mm, double ostium_radius_mm, double min_air_ml,
         double max_memory_gib, const py::object& progress,
         const std::shared_ptr<CancelToken>& cancel, int threads) {
        return segment(ct,
                       {bone_hu, skin_hu, min_bone_ml, nostril_radius_mm, ostium_radius_mm,
                        min_air_ml, max_memory_gib},
                       {progress, cancel, threads});
      },
      py::arg("ct"), py::kw_only(), py::arg("bone_hu") = defaults.bone_hu,
      py::arg("skin_hu") = defaults.skin_hu, py::arg("min_bone_ml") = defaults.min_bone_ml,
      py::arg("nostril_radius_mm") = defaults.nostril_radius_mm,
      py::arg("ostium_radius_mm") = defaults.ostium_radius_mm,
      py::arg("min_air_ml") = defaults.min_air_ml,
      py::arg("max_memory_gib") = defaults.max_memory_gib, py::arg("progress") = py::none(),
      py::arg("cancel") = py::none(), py::arg("threads") = 0, doc("anatomy::segment_tissue"));
  module.def(
      "reduce_metal_streaks",
      [](const OwnedCt& ct, double bone_hu, double skin_hu, int threads) {
        return reduce_streaks(ct, bone_hu, skin_hu, {py::none(), nullptr, threads});
      },
      py::arg("ct"), py::kw_only(), py::arg("bone_hu") = defaults.bone_hu,
      py::arg("skin_hu") = defaults.skin_hu, py::arg("threads") = 0,
      doc("anatomy::reduce_metal_streaks"));
  module.def("find_thresholds", &find_thresholds, py::arg("ct"), doc("anatomy::find_thresholds"));
  module.def(
      "tissue_volumes_ml",
      [](const OwnedLabels& labels) {
        py::dict volumes;
        for (const auto& [name, volume_ml] : anatomy::tissue_volumes_ml(*labels))
          volumes[py::str(name)] = volume_ml;
        return volumes;
      },
      py::arg("labels"), doc("anatomy::tissue_volumes_ml"));
  bind_files(module);
}

}  // namespace lefort::python
