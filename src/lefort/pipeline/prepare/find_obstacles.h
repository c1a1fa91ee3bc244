/// \file
/// The obstacles that contact reads in place of the bones of a plan.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/plan_file.h>
#include <lefort/pipeline/cache/stage_cache.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/prediction_options.h>

namespace lefort::pipeline {

/// Motion that obstacles are made for.
enum class ObstacleMotion {
  kPlanned,  ///< The paths of the plan.
  kAny,      ///< Of up to 20 mm, with all cuts open.
};

/// Sets the obstacle (predict/regularized_bone.h) of each bone of a model, if the plan has them and
/// tissue can slide on bone. A bone that the mesh cannot resolve keeps none, with a warning.
///
/// \param model      with its tissue at rest.
/// \param plan       its contact and field are used, and its paths for kPlanned.
/// \param tissue     options of the mesh whose elements the obstacles resolve: the model's, or a
///   finer one.
/// \param interface  of the model.
/// \param motion     determines the reach of the obstacles and which cuts are open.
/// \param progress   receives the distance of each obstacle from its bone.
/// \returns nothing, or the errors of find_field() and predict::regularize_bone().
[[nodiscard]] Result<void> find_obstacles(predict::FaceModel& model, const io::PlanFile& plan,
                                          const predict::TissueOptions& tissue,
                                          predict::TissueInterface interface, ObstacleMotion motion,
                                          const StageCache& cache, Progress& progress);

}  // namespace lefort::pipeline
