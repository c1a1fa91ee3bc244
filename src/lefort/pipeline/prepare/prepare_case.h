/// \file
/// From scan and plan to all that a prediction needs, with costly stages cached.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/layer_thickness.h>
#include <lefort/pipeline/cache/stage_cache.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/predict/bone_overlap_at_fraction.h>
#include <lefort/predict/predict_face.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// What made a result.
struct Provenance {
  std::string plan_sha256;                  ///< Of the plan file's text.
  std::vector<io::InputFile> plan_files{};  ///< That the plan names, but for the scan.
  std::string ct_sha256;                    ///< Of the imported voxels and their grid.
  std::string ct_kind;
  std::string labels_sha256;
  std::string labels_source;          ///< "segmented" by us, or a "file" that the plan names.
  std::vector<std::string> warnings;  ///< Of the import.
};

/// A case before anything moves. Immutable once prepared.
struct PreparedCase {
  io::PlanFile plan;
  Provenance provenance;
  image::Grid scan_grid;
  std::vector<std::pair<std::string, double>> tissue_volumes_ml;
  geometry::TriangleMesh skin_L;
  plan::CutSegments cut;
  predict::FaceModel model;
  mesh::MeshQuality quality;
  std::optional<mesh::LayerThickness> skin_layer;  ///< If the plan has skin of its own.
  /// Where the plan moves bone into bone: for each step each segment with those after it and with
  /// the bone that stays. Of that bone no vertices' depths.
  std::vector<predict::BoneOverlapAtFraction> overlaps;

  [[nodiscard]] std::vector<geometry::RigidPath> paths() const {
    return plan::paths_of(plan.segments);
  }
  [[nodiscard]] int steps() const { return geometry::steps_of(paths()); }
};

/// One sentence on where the path drives bone through bone; `pair` is one of prepared.overlaps.
[[nodiscard]] std::string describe(const predict::BoneOverlapAtFraction& pair,
                                   const io::PlanFile& plan);

/// \param plan         read from a file whose text hashes to `plan_sha256`.
/// \param ct           the scan.
[[nodiscard]] Result<PreparedCase> prepare_case(io::PlanFile plan, const std::string& plan_sha256,
                                                const std::filesystem::path& ct,
                                                const StageCache& cache, Progress& progress);

}  // namespace lefort::pipeline
