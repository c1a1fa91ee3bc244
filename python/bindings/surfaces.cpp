#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/mesh/finish_surface.h>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "call.h"
#include "docstring.h"
#include "meshes.h"
#include "segmentation.h"
#include "volumes.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
using anatomy::Bones;
using anatomy::LevelOptions;

Bones bones_of(const std::string& name) {
  if (name == "all") return Bones::kAll;
  if (name == "skull") return Bones::kSkull;
  if (name == "mandible") return Bones::kMandible;
  raise_invalid(fmt::format("bones is \"{}\"; all, skull or mandible wanted", name));
}

mesh::SurfaceFinish finish_of(int smoothing_passes, std::optional<Index> triangles) {
  if (smoothing_passes < 0) raise_invalid("smoothing_passes must be 0 or more");
  if (triangles && *triangles < 4) raise_invalid("triangles must be 4 or more");
  return {smoothing_passes, triangles};
}

/// The zero surface of level(), smoothed.
template <class Level>
SharedMesh surface(const OwnedCt& ct, const OwnedLabels& labels, const mesh::SurfaceFinish& finish,
                   const CallOptions& options, const Level& level) {
  check_same_grid((*ct).grid, (*labels).grid);
  return shared(call(options, [&](Progress& progress) -> Result<geometry::TriangleMesh> {
    progress.begin_stage("extract a surface");
    LEFORT_TRY(const geometry::TriangleMesh isosurface_L,
               anatomy::extract_isosurface(level(), {}, progress));
    progress.begin_stage("smooth and check it");
    LEFORT_TRY(
        mesh::FinishedSurface finished,
        mesh::finish_surface(isosurface_L, (*ct).grid.spacing_mm.minCoeff(), finish, progress));
    return std::move(finished.mesh_L);
  }));
}

}  // namespace

void bind_surfaces(py::module_& module) {
  const LevelOptions defaults;
  module.def(
      "bone_surface",
      [](const OwnedCt& ct, const OwnedLabels& labels, const std::string& bones, double bone_hu,
         double skin_hu, int smoothing_passes, std::optional<Index> triangles,
         const py::object& progress, const std::shared_ptr<CancelToken>& cancel, int threads) {
        const LevelOptions levels{.bone_hu = bone_hu, .skin_hu = skin_hu};
        const Bones which = bones_of(bones);
        return surface(
            ct, labels, finish_of(smoothing_passes, triangles), {progress, cancel, threads}, [&] {
              return anatomy::bone_level(*ct, *labels, anatomy::Cavities::kKeep, levels, which);
            });
      },
      py::arg("ct"), py::arg("labels"), py::kw_only(), py::arg("bones") = "all",
      py::arg("bone_hu") = defaults.bone_hu, py::arg("skin_hu") = defaults.skin_hu,
      py::arg("smoothing_passes") = 10, py::arg("triangles") = py::none(),
      py::arg("progress") = py::none(), py::arg("cancel") = py::none(), py::arg("threads") = 0,
      doc("anatomy::bone_level"));
  module.def(
      "skin_surface",
      [](const OwnedCt& ct, const OwnedLabels& labels, double bone_hu, double skin_hu,
         int smoothing_passes, std::optional<Index> triangles, const py::object& progress,
         const std::shared_ptr<CancelToken>& cancel, int threads) {
        const LevelOptions levels{.bone_hu = bone_hu, .skin_hu = skin_hu};
        return surface(ct, labels, finish_of(smoothing_passes, triangles),
                       {progress, cancel, threads},
                       [&] { return anatomy::skin_level(*ct, *labels, levels); });
      },
      py::arg("ct"), py::arg("labels"), py::kw_only(), py::arg("bone_hu") = defaults.bone_hu,
      py::arg("skin_hu") = defaults.skin_hu, py::arg("smoothing_passes") = 10,
      py::arg("triangles") = py::none(), py::arg("progress") = py::none(),
      py::arg("cancel") = py::none(), py::arg("threads") = 0, doc("anatomy::skin_level"));
}

}  // namespace lefort::python
