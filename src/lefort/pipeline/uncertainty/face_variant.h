/// \file
/// Models of a face for samples of its inputs: one for each combination of the levels of inputs
/// that change mesh or boundary conditions; other inputs change poses and forces of such a model.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/uncertainty/uncertain_inputs.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/face_response.h>

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// Values of the inputs in levels.
struct VariantKey {
  std::optional<double> margin_mm;  ///< None: that of the plan.
  double threshold_hu = 0.0;        ///< Added to that of the plan.
  double landmark_mm = 0.0;         ///< Factor on the pattern of errors.

  [[nodiscard]] auto operator<=>(const VariantKey&) const = default;
};

/// \param values  one per input.
[[nodiscard]] VariantKey variant_of(std::span<const UncertainInput> inputs,
                                    std::span<const double> values);

/// A model with its nominal equilibrium: at the end of the planned paths, with the materials and
/// stiffnesses of the plan.
struct FaceVariant {
  std::vector<std::string> names;  ///< Of the segments.
  predict::PredictionOptions options;
  predict::FaceModel model;
  predict::SkinEmbedding embedding;                 ///< Of the skin of the plan.
  std::vector<RigidTransform> planned_LB;           ///< Final pose of each segment.
  std::vector<std::vector<RigidTransform>> way_LB;  ///< Poses at keyframes, the last are the final.
  std::vector<Vec3> centroids_B;                    ///< Of the vertices of each segment.
  predict::FaceState nominal;
};

/// \param prepared   the case with the anatomy of this variant.
/// \param tissue     mesh and materials.
/// \param margin_mm  see VariantKey.
/// \param skin_L     surface whose displacement is sought: the same for all variants.
/// \param cache      of the mesh.
/// \returns the errors of remodel_face() and predict::FaceResponse.
[[nodiscard]] Result<FaceVariant> make_variant(const PreparedCase& prepared,
                                               const predict::TissueOptions& tissue,
                                               const std::optional<double>& margin_mm,
                                               const geometry::TriangleMesh& skin_L,
                                               const StageCache& cache, Progress& progress);

/// Where a solve starts.
enum class StartState {
  kNominal,  ///< The nominal equilibrium of the variant.
  kRest,     ///< The face at rest; then along the planned paths.
};

/// An equilibrium of a sample.
struct SampleSolution {
  std::vector<Vec3> skin_mm;  ///< Displacement of each vertex of the skin.
  Index newton_iterations = 0;
};

/// \param values    one per input.
/// \param progress  may request a stop.
/// \returns the errors of predict::FaceResponse.
[[nodiscard]] Result<SampleSolution> solve_sample(const FaceVariant& variant,
                                                  std::span<const UncertainInput> inputs,
                                                  std::span<const double> values, StartState start,
                                                  Progress& progress);

/// Displacement of the skin in the nominal equilibrium.
[[nodiscard]] std::vector<Vec3> nominal_skin_mm(const FaceVariant& variant);

/// Relative tolerance of the residual of samples. That of a plan, 1e-6, changes the skin of a small
/// head by 0.0004 mm at most (docs/studies/uncertainty.md).
inline constexpr double kSampleTolerance = 1e-4;

}  // namespace lefort::pipeline
