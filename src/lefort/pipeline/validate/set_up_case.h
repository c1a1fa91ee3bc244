/// \file
/// A case of a cohort before its prediction: plan, bones, and the achieved face in L.
#pragma once

#include <lefort/compare/face_regions.h>
#include <lefort/compare/register_surface.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/pipeline/validate/find_cases.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/landmarks.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct SetupOptions {
  bool achieved_movements = false;          ///< ValidateJob::achieved_movements.
  std::optional<double> element_size_mm{};  ///< Instead of the plan's.
  double voxel_mm = 1.0;                    ///< ValidateJob::voxel_mm.
};

struct CaseSetup {
  std::filesystem::path plan;            ///< Of the prediction, with scan and movements.
  std::filesystem::path cache;           ///< Of the prediction.
  plan::CutSegments cut;                 ///< The bones before surgery.
  std::vector<std::string> segments;     ///< Names.
  std::vector<RigidTransform> moved_LB;  ///< Pose of each segment at the end of its path.
  /// Whether the movement of a segment or more was found in the bone after surgery.
  bool has_achieved_movements = false;
  geometry::TriangleMesh skin_after_L;
  /// Registration of the bone after surgery; none if only the skin is known, which is in frame L.
  std::optional<compare::Registration> registration{};
  plan::Landmarks landmarks;  ///< Before surgery; may be empty.
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
struct CaseRegions {
  std::vector<compare::FaceRegion> of_vertex;  ///< Of the skin before surgery.
  bool are_estimated = false;                  ///< By compare::estimate_landmarks().
};

/// \param setup   its landmarks and bones are used.
/// \param skin_L  before surgery.
/// \returns the regions; the errors of FaceRegions::from() and estimate_landmarks(); or
///   kAnatomyMissing if no vertex lies in a region.
[[nodiscard]] Result<CaseRegions> find_regions(const CaseSetup& setup,
                                               const geometry::TriangleMesh& skin_L);

}  // namespace lefort::pipeline
