/// \file
/// A case of a cohort before its prediction: plan, bones, and the achieved face in L.
#pragma once

#include <lefort/compare/face_regions.h>
#include <lefort/compare/register_surface.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/parameter_sets.h>
#include <lefort/pipeline/cache/stage_cache.h>
#include <lefort/pipeline/validate/find_cases.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/landmarks.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct SetupOptions {
  bool achieved_movements = false;                  ///< ValidateJob::achieved_movements.
  std::optional<double> element_size_mm{};          ///< Instead of the plan's.
  double voxel_mm = 1.0;                            ///< ValidateJob::voxel_mm.
  io::ParameterSet parameters = io::default_set();  ///< Merged into the plan.
  std::optional<SharedCache> shared_cache{};        ///< Instead of a cache in the work folder.
  bool link_inputs = false;                         ///< CaseFiles::link_inputs.
};

struct CaseSetup {
  std::filesystem::path plan;                 ///< Of the prediction, with movements.
  std::optional<std::filesystem::path> ct{};  ///< The scan, if the plan does not name it.
  StageCache cache{std::filesystem::path()};  ///< Of the prediction.
  plan::CutSegments cut;                      ///< The bones before surgery.
  std::vector<std::string> segments;          ///< Names.
  std::vector<RigidTransform> moved_LB;       ///< Pose of each segment at the end of its path.
  /// Whether the movement of a segment or more was found in the bone after surgery.
  bool has_achieved_movements = false;
  geometry::TriangleMesh skin_after_L;  ///< Empty if the case has no face after surgery.
  /// Registration of the bone after surgery; none if only the skin is known, which is in frame L.
  std::optional<compare::Registration> registration{};
  /// Before surgery: of the case, and found in its scan if those do not define all regions.
  plan::Landmarks landmarks;
  bool are_landmarks_found = false;
};

/// Makes scan and labels if the case has surfaces only, cuts the bones, registers the head after
/// surgery, finds the movements if necessary, and writes the plan of the prediction to
/// `work`/plan.json.
///
/// \param one      the case.
/// \param work     folder for the files of this case.
/// \param options  see SetupOptions.
/// \returns the setup; kPlanInvalid if the movement is neither in the plan nor in bone after
///   surgery; or the errors of reading, segmenting, cutting and registering.
[[nodiscard]] Result<CaseSetup> set_up_case(const CohortCase& one,
                                            const std::filesystem::path& work,
                                            const SetupOptions& options, Progress& progress);

/// Regions of a face before surgery.
///
/// \param setup   its landmarks are used.
/// \param skin_L  before surgery.
/// \returns the region of each vertex; or what FaceRegions::from() returns; or kAnatomyMissing if
///   landmarks are missing, or no vertex lies in a region.
[[nodiscard]] Result<std::vector<compare::FaceRegion>> find_regions(
    const CaseSetup& setup, const geometry::TriangleMesh& skin_L);

}  // namespace lefort::pipeline
