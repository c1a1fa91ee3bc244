/// \file
/// Prepares a prediction from scan and plan. Results of stages that take long are cached.
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
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/predict/bone_overlap_at_fraction.h>
#include <lefort/predict/face_preview.h>
#include <lefort/predict/jaw_teeth.h>
#include <lefort/predict/predict_face.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// Inputs of a result.
struct Provenance {
  std::string plan_sha256;                  ///< Of the plan file's text.
  std::vector<io::InputFile> plan_files{};  ///< Named by the plan, except the scan.
  std::string ct_sha256;                    ///< Of the imported voxels and their grid.
  std::string ct_kind;
  std::string labels_sha256;
  std::string labels_source;          ///< "segmented" by lefort, or "file": named by the plan.
  std::vector<std::string> warnings;  ///< Of the import.
};

/// A case in the reference configuration. Immutable once prepared.
struct PreparedCase {
  io::PlanFile plan;
  Provenance provenance;
  image::Grid scan_grid;
  std::vector<std::pair<std::string, double>> tissue_volumes_ml;
  geometry::TriangleMesh skin_L;
  plan::CutSegments cut;
  predict::FaceModel model;
  mesh::MeshQuality quality;
  std::optional<mesh::LayerThickness> skin_layer;  ///< If the plan has a material for skin.
  /// Overlap of each segment with every later one and with the stationary bone, at each step.
  std::vector<predict::BoneOverlapAtFraction> overlaps;
  ScannedHead head;
  std::optional<predict::BoundaryLabelMap> painted;  ///< Boundary conditions painted by the user.
  /// Of interface and lips.
  std::optional<predict::JawTeeth> teeth = std::nullopt;

  [[nodiscard]] std::vector<geometry::RigidPath> paths() const {
    return plan::paths_of(plan.segments);
  }
  /// Names of the segments, in the order of the plan.
  [[nodiscard]] std::vector<std::string> segment_names() const {
    std::vector<std::string> names;
    for (const plan::PlannedSegment& segment : plan.segments)
      names.push_back(segment.osteotomy.segment);
    return names;
  }
  [[nodiscard]] int steps() const { return geometry::steps_of(paths()); }
};

/// Segments the scan, cuts the bone, builds the distance fields, and meshes the tissue.
///
/// \param plan         read from a file whose text hashes to `plan_sha256`.
/// \param plan_sha256  SHA-256 of the text of the plan.
/// \param ct           the scan.
/// \param cache        of labels, fields and the tissue's mesh.
/// \returns the case; the errors of scan_head(), load_teeth(), io::read_boundary_labels(),
///   plan::cut_segments(), field::build_distance_field(), predict::check_query_range(), and
///   predict::mesh_tissue() or predict::mesh_tissue_and_skin(); or kPlanInvalid if the plan has a
///   material for muscle and the labels contain no muscle.
[[nodiscard]] Result<PreparedCase> prepare_case(io::PlanFile plan, const std::string& plan_sha256,
                                                const std::filesystem::path& ct,
                                                const StageCache& cache, Progress& progress);

/// The preview of a prepared case. Its obstacles have the resolution of the plan's own mesh and are
/// those of cuts that have opened, for any motion of up to 20 mm.
///
/// \param skin_L  the surface that is displaced.
/// \returns the preview; the errors of remodel_face() and predict::FacePreview::create().
[[nodiscard]] Result<predict::FacePreview> preview_face(const PreparedCase& prepared,
                                                        const geometry::TriangleMesh& skin_L,
                                                        const StageCache& cache,
                                                        Progress& progress);

/// Makes the model of a prepared case again with another mesh or interface; bones and the fields of
/// segments are those of the case.
///
/// \param tissue    sizes and materials.
/// \param boundary  interface and boundaries.
/// \param cache     of the mesh and of the field of stationary bone.
/// \returns the model, or the errors of predict::mesh_tissue() or predict::mesh_tissue_and_skin(),
///   and field::build_distance_field().
[[nodiscard]] Result<predict::FaceModel> remodel_face(const PreparedCase& prepared,
                                                      const predict::TissueOptions& tissue,
                                                      const predict::BoundaryOptions& boundary,
                                                      const StageCache& cache, Progress& progress);

}  // namespace lefort::pipeline
